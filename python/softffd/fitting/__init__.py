"""Parameters from measured curves."""
