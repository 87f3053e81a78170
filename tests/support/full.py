"""Tests that only `scripts/test --full` and `--changed` run: what takes minutes, and what a change of the program hardly concerns."""
import os
import unittest

FULL = os.environ.get("EULASTIC_FULL") == "1"
full = unittest.skipUnless(FULL, "part of scripts/test --full")
