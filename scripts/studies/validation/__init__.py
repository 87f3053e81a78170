"""The cases of scripts/validate: what is run, what is measured, what it is compared with."""
