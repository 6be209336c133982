"""The stages of the discovery, one a file, each from a state to a state; :mod:`..pipeline` lists them in order."""
