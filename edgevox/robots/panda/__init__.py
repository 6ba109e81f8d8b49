"""`robot-panda`: a Franka Panda at a table with three cubes and two bins, simulated with MuJoCo.

Imports core, agent.skills, agent.text and the robots' shared parts. The robot's model comes in
as a path.
"""

import edgevox.robots.mujoco as _shared_first  # noqa: F401 - mujoco is imported by it, shielded
