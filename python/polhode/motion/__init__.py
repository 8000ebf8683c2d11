"""Motions: trajectories, closed forms, events, gyrostats."""
