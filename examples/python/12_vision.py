"""12: what cameras of a world measure: points, depth and pictures as arrays; a map of scans; a policy that reads points.

    python3 12_vision.py [steps]
"""
import sys

import numpy as np

import redman

steps, task = int(sys.argv[1]) if len(sys.argv) > 1 else 20, "grasp"

pool = redman.Pool(task, num_envs=2, seed=1, options={"modality": "points+depth", "points": 512})
pool.reset()
for _ in range(steps):
    pool.step(pool.baseline("hold"))
seen = pool.sensors                                 # views of the library's memory, which every step writes
print(f"points {seen.points.shape} in m, of cameras {', '.join(camera.name for camera in seen.cloud_cameras)}")
print(f"depth {seen.depth.shape} in m: {seen.depth[0][seen.depth[0] > 0].min():.2f} m to what is nearest (0: nothing is there)")
for name in ("right_forearm", "right_palm", "right_ff_distal", "object"):
    shapes = [i for i, shape in enumerate(pool.shapes) if shape.name == name]
    cloud = seen.points[0, np.isin(seen.point_shape[0], shapes)]
    print(f"  {len(cloud):3} points on {name}, about {np.round(cloud.mean(axis=0), 2) if len(cloud) else 'nowhere'}")

scanned = redman.Map(resolution=0.02)               # voxels that are occupied, free or unknown
scanned.scan(pool, env=0, camera="above", width=96, height=96)
print(f"map: probability that the first point is occupied: {scanned.query(seen.points[0, :1])[0]:.2f}")

# An agent with an encoder reads the points beside what a robot measures of itself.
pool = redman.Pool("hand_over_safe_finger", num_envs=8, seed=1, options={"modality": "points", "points": 128})
agent = redman.Agent(pool, options={"encoder": "32,64", "encoder_points": 128, "actor_obs": "vision"})
pool.reset()
row = agent.rollout(pool)
print(f"one epoch from points: {row.env_steps} control steps, {agent.policy().info.num_points} points a decision")
