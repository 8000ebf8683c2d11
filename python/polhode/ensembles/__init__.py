"""Ensembles: draw, run, collect and reduce members, on one machine or a cluster."""
