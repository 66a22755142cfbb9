"""Hops: the protocol of this Grasshopper component for functions on a server, and the functions."""
