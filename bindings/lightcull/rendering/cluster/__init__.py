"""Renders that are shared out by Dask. From the bottom up: what is sent (order, scene_transport), what
workers do with it (worker), who takes part (lost, pool), chunks on their way (flow), a source of chunks
(cluster_chunks), frames (frames), and how to get at a cluster (connection). What uses `distributed`, which
is optional, is imported only where a cluster is asked for.
"""
