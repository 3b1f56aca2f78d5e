"""Packages scenes as FMUs; opens and runs FMUs."""
