"""Solves through ``compas.rpc``: see :mod:`compas_cgc.rpc.service`."""
