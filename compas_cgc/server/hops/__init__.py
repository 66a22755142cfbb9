"""The protocol of Hops, Grasshopper's component for functions on a server, and the functions."""
