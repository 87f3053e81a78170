"""The cases of scripts/validate: the runs, the measured quantities, and their references."""
