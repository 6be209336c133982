"""The paper again: its tables and figures computed from the twin and the diagnosis, beside what it prints."""
