from __future__ import annotations

import hypothesis

# The compiled kernels make the first example of a property slow, so no deadline.
hypothesis.settings.register_profile("default", deadline=None, max_examples=40, derandomize=True)
hypothesis.settings.load_profile("default")
