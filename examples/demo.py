"""The pipeline in numbered steps: captures in, a checked crowd out. `python examples/demo.py [FOLDER] [SEED]`."""

import sys
from pathlib import Path

import crowdquilt as cq

out = Path(sys.argv[1] if len(sys.argv) > 1 else "out/example")
seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1

cq.samples.write(out / "captures", seed)  # 1. generated captures of people who walk, meet and touch
patches = cq.patch.cut(out / "captures")  # 2. motion patches cut out of them
outcome = cq.tiling.tile(cq.Scene.demo(), patches, seed=seed)  # 3. patches tiled until no end is loose
report = cq.check.check(outcome.crowd)  # 4. the result verified from itself alone
outcome.crowd.save(out / "crowd.crowd")  # 5. written for `crowdquilt view`
cq.export.save_glb(outcome.crowd, out / "crowd.glb")  # ... and for Blender and engines
print(report)
print(f"{outcome}: {out / 'crowd.crowd'}")
