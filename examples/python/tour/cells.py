"""The cells of tour.ipynb, which make.py runs: "# %%" begins code, "# %% text" begins Markdown."""
# %% text
# # A tour of redman
#
# Two hands, a cost limit, and what a notebook shows of them. All outputs below are stored in this file; run it to get your own.
# [The manual](../manual/python.md) has all names and rules, and [twelve programs](README.md) show one idea each.
# %% text
# ## Worlds
# A pool is many worlds of one task that are stepped together. Its rows are numpy arrays, one row for each world. As the last line of
# a cell, a pool draws its worlds and their numbers.
# %%
import redman

pool = redman.Pool("hand_over_safe_finger", num_envs=4, seed=7, options={"object": "egg"})
pool.reset()
for _ in range(20):
    pool.step(pool.baseline("hold"))
print(pool.obs.shape, pool.action.shape, pool.cost_names[:3])
pool
# %% text
# ## A policy
# Every bundled task has a policy. It draws itself as an episode in 3D: drag to rotate, press space to play. Below the scene are the
# return and each cost with its limit.
# %%
policy = redman.Policy.trained("hand_over_safe_finger")
policy
# %% text
# How good it is, over 100 episodes, with intervals by a bootstrap:
# %%
redman.evaluate(policy)
# %% text
# The same episode as a file: `.html` for a browser, `.png`, `.mp4` or `.gif` (films need ffmpeg), `.glb` for 3D programs.
# %%
policy.render("throw.html")
policy.render("throw.png", strip=4, width=320, height=240)
# %% text
# ## A cost limit
# `ppo` only records costs, `ppo_lag` keeps them below the limit of 25. Two seeds of each, in worlds of a ball that should run fast and
# not too fast. `compare` shows the seeds as bands, and the limit as a dashed line.
# %%
runs = redman.train("ball_run", ["ppo", "ppo_lag"], steps=2e5, seed=[0, 1], progress=False)
redman.compare(runs)
# %% text
# ## A cost of your own
# A function of the rows after each control step is a cost, with a limit of its own. The run is learned, chosen and evaluated by it.
# %%
def fast(rows):
    return rows.speed("velocity") > 1.5


own = redman.train("ball_run", steps=2e5, costs={"fast": fast}, cost_limits={"fast": 20}, progress=False)
own.curve
# %%
own.judged()
# %% text
# ## What you do yourself
# `pool.record()` keeps what you do with a world, to look at afterwards. Here random actions have the egg.
# %%
with redman.Pool("hand_over_safe_finger", options={"object": "egg"}) as pool:
    pool.reset(seeds=1)
    with pool.record() as episode:
        for _ in range(40):
            pool.step(pool.baseline("random"))

episode
# %% text
# ## A window
# `redman.view(pool)` opens a page on worlds while you step them: pause, pull the egg with the mouse, act by hand. `redman.view(policy)` and
# `redman.train(..., view=True)` are alike. [The manual](../manual/view.md) describes the page.
