"""All reference cases, in the order of docs/validation.md."""
from validation import bodies, drops, fluid, long_runs, membranes, properties, rigid, solid, startups, surfaces, tumbling

CASES = sum((part.CASES for part in (fluid, solid, bodies, drops, membranes, tumbling, startups, rigid, long_runs, surfaces, properties)), ())
