"""Rendering one image. From the bottom up: what is asked for (settings, budget, method), what is told
(progress, statistics, result), jobs that render pass by pass (path_job, virtual_light_job), what any
renderer has to offer (subject), and `render`.
"""
