"""Many runs of one FMU over a grid of values: what is asked, the runs, their table and its picture."""
