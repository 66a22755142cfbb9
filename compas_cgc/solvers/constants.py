"""Numerical constants that several solvers share.

The local frame has its origin at the centroid of the drawing and unit size.
"""

from __future__ import annotations

import math

__all__ = [
    "ANGLE_ROUNDING",
    "ARMIJO",
    "COARSE_VERTICES",
    "CONVERGED",
    "DECREASE",
    "ELSEWHERE",
    "EVEN_VERTICES",
    "FACING",
    "FACTORS",
    "GROUND",
    "KRYLOV",
    "LARGEST_FACTOR",
    "LARGE_MESH",
    "LOCAL_ROUNDING",
    "LONGEST",
    "LOOSE_RESIDUAL",
    "MAX_STEPS",
    "MEDIUM_MESH",
    "MULTIPLIER_MARGIN",
    "PATIENCE",
    "ROUNDINGS",
    "RUNAWAY",
    "SHAPE_KEPT",
    "SHORTEST",
    "SIDE_SHARE",
    "SMALLEST_FACE",
    "TIGHT_RESIDUAL",
    "TWIN_ENERGIES",
    "WEIGHT_DECAY",
    "WITHIN_REACH",
    "WORTHWHILE",
]

# Rounding and convergence
ANGLE_ROUNDING = 5e-15  # rounding error of the sum of the angles of a ring [rad]; 22 rounding errors, for six angles and their sum of 2π
LOCAL_ROUNDING = 1e-13  # residual or distance in the local frame at rounding level [L or rad]; 450 rounding errors of numbers near 1
ROUNDINGS = 4.0  # multiple of the estimated rounding error up to which a residual is zero; the estimate omits errors of normals and areas
CONVERGED = 1e-10  # relative residual or step of a converged iteration; the next Newton step, with its square, is at rounding level
TWIN_ENERGIES = 1e-3  # relative difference of the energies of mirror twins; irregular triangles are not mirror images

MAX_STEPS = 30  # steps or rounds of a search [steps]; bounds the time, as converging searches need fewer
PATIENCE = 10  # steps in a row without sufficient gain that end a search [steps]; it may pass a vertex whose moves hardly change its angles
LONGEST = 0.25  # longest move in a step relative to the size of the mesh; a quadratic model of a shape holds no farther
LARGEST_FACTOR = math.log(2.0)  # largest change of the logarithm of a constant in a step; a factor of 2, which keeps its sign
SHORTEST = 1e-3  # fraction of a step below which a line search fails; ten halvings, after which the direction is not one of descent
ARMIJO = 1e-4  # fraction of the predicted decrease of a residual that a step has to bring; Nocedal and Wright, section 3.1
DECREASE = 1e-2  # fraction of the predicted decrease of a merit function that a step has to bring; refuses steps that wander on flat merits
MULTIPLIER_MARGIN = 1.5  # weight of residuals in the merit over the largest multiplier; above 1 the merit is exact (Nocedal and Wright)
WEIGHT_DECAY = 0.7  # fraction of that weight that remains as multipliers decrease; abrupt changes of the merit let searches cycle
WORTHWHILE = 0.5  # factor on the residual that further steps have to bring; slower ones do not reach rounding level within the step limit
ELSEWHERE = 1e-2  # step relative to the size of the mesh that leads to another surface; corrections of a converged surface are far smaller
RUNAWAY = 2.0  # move of a vertex in diagonals of the drawing, from which a search diverges; no surface is that far from its drawing
WITHIN_REACH = 0.5  # relative error of K within which Newton's method needs no other start; beyond, steps lose convexity

KRYLOV = 60  # directions of Krylov methods; bounds the time, and a later step corrects an inexact one
LOOSE_RESIDUAL = 1e-3  # relative residual of linear systems far from convergence; steps of Newton's method then miss by as little
TIGHT_RESIDUAL = 1e-6  # relative residual of linear systems near convergence; preserves quadratic convergence to the last but one step
FACTORS = 20  # work of a factorisation for moves along normals [right sides]; estimate of the time, which affects the work limit only

# Drawings
GROUND = 1e-10  # stiffness of motions that do not bend relative to that of bending; makes plates definite and moves heights by as little
SIDE_SHARE = 0.05  # depth or volume of a drawing relative to those of a dome with its K, from which it decides the side; noise is smaller
SMALLEST_FACE = 1e-6  # area of a face or cell relative to the mean below which it is a sliver; normals of slivers are rounding errors
FACING = 0.5  # length of the mean normal over the area from which a drawing has a plan; a half sphere has 0.5
# bending of a drawing over that of the plate on its supports, from which its shape is kept; what supports explain is not a shape
SHAPE_KEPT = 3.0

# vertices of the even triangles on which branches and lines are found [vertices]; heights on them are within 1 % of the limit
EVEN_VERTICES = 600
MEDIUM_MESH = 1000  # vertices above which a search begins on a coarser mesh [vertices]; below, this saves no time
# vertices of coarser meshes for the projection [vertices]; its surfaces differ by less than 1e-3 of the size from finer ones
COARSE_VERTICES = 2000
# vertices from which a search on a coarser mesh pays, and linear systems are solved with old factors [vertices]; below, it saves no time
LARGE_MESH = 6000
