"""Runs of a sweep of which the second one takes its process down; in a module of its own for the processes to import."""

import os

import numpy as np


def run_list(_plan, runs):
    return os._exit(1) if (1,) in runs else [np.array([1.0]) for _ in runs]
