"""Studies at scale: jobs in chunks on a process pool or a Dask cluster, resumable."""
