"""Imports all rows, in the order of the table."""

import rows_steps  # noqa: F401, I001
import rows_parts  # noqa: F401
import rows_damped  # noqa: F401
import rows_vertices  # noqa: F401
import rows_runs  # noqa: F401
import rows_files  # noqa: F401
import rows_vibration  # noqa: F401
