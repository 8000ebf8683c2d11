"""Ensembles: how members are drawn, run, gathered and reduced, on one machine or a cluster."""
