"""The published cases, in the order of the page."""

from __future__ import annotations

from validation.published import bars, bending, blocks, spheres, vibration
from validation.published.cases import Body, Case


def springs(*points: int) -> Body:
    nx, ny, nz = points
    return Body("springs", (nx, ny, nz))


def solid(ratio: float, *points: int) -> Body:
    nx, ny, nz = points
    return Body("solid", (nx, ny, nz), ratio)


ELASTICA = (springs(31, 4, 4), solid(0.0, 31, 4, 4), solid(0.0, 25, 4, 4))
BISSHOPP = "K. E. Bisshopp, D. C. Drucker 1945, [doi:10.1090/qam/13360](https://doi.org/10.1090/qam/13360)"
SLENDER = (
    "Beams of 31 points are 10 times as long as high, that of 25 points 20 times. The reference neglects shear and stretch, which add "
    "about (h / L)2: 1 to 2 % and 0.3 to 0.5 %."
)

CASES = (
    Case(
        "Elastica under an end load",
        f"{BISSHOPP}; the numbers are quadratures of its equations, to all digits shown",
        "A beam is clamped at one end, and a dead load P at the other bends it: deflection and shortening of its end by its length L at "
        "P L2 / (E I) = 1, 2 and 10. Drag brings it to rest, and the next load acts from there.",
        SLENDER,
        bending.end_load,
        ELASTICA,
    ),
    Case(
        "Elastica under its own weight",
        f"the equations of {BISSHOPP}, with the weight q of a length in the place of the end load, integrated to all digits shown",
        "The same beams bend in a field of gravity: q L3 / (E I) = 1, 4 and 10.",
        SLENDER,
        bending.own_weight,
        ELASTICA,
    ),
    Case(
        "Beam rolled up by a moment",
        "case V6.04.138 of [code_aster](https://www.code-aster.org) and test CantileverIntoCircle of [MuJoCo](https://mujoco.org): a beam "
        "that is bent to an arc of M L / (E I) = t has the shortening 1 - sin t / t and the deflection (1 - cos t) / t",
        "A beam is clamped at one end, and a moment M at the other bends it to a quarter, half and a whole circle. Forces on two edges of "
        "the end make the moment, and the host turns them with it. Walls without friction hold the beam in its plane. The beam of 31 "
        "points is 25 times as long as high, that of 25 points 20 times. Of springs there is none: they have Poisson's ratio 1/4, and "
        "walls would stiffen them.",
        "The reference is a thin beam of a linear material. Here strains reach 13 and 16 %, and errors are as the square of height by "
        "length; patches half as long change them by at most a twenty-fifth.",
        bending.roll_up,
        (solid(0.0, 31, 4, 4), solid(0.0, 25, 4, 4)),
    ),
    Case(
        "Frequencies of a clamped beam",
        "S. Timoshenko 1921, [doi:10.1080/14786442108636264](https://doi.org/10.1080/14786442108636264), with the shear factor of G. R. "
        "Cowper 1966, 10 (1 + nu) / (12 + 11 nu)",
        "A beam of 0.2 x 0.02 x 0.02 m, 1 MPa and 1100 kg/m3 is bent by forces of a mode's shape and let go without damping. The share of "
        "the mode is read for 10 periods.",
        "The reference leaves out what the clamp holds: with a Poisson's ratio the end cannot contract, which raises all three by 0.4 %. "
        "Seven points across in place of four lower those of a solid by at most 0.05 %. Euler and Bernoulli's beam, without shear and "
        "inertia of turning, has 2.435, 15.26 and 42.73 Hz.",
        vibration.clamped_beam,
        (springs(31, 4, 4), solid(0.0, 31, 4, 4), solid(0.25, 31, 4, 4)),
    ),
    Case(
        "Strip that oscillates in plane strain",
        "L. D. Landau, E. M. Lifshitz, Theory of Elasticity, for case oscillating_beam of [SPHinXsys](https://www.sphinxsys.org): "
        "1.8751042 / (2 pi) h / L2 sqrt(E / (12 rho (1 - nu2))) 1.8751042",
        "A strip of 0.2 x 0.02 m, 2 MPa, Poisson's ratio 1/4 and 1000 kg/m3 in plane strain is clamped at its end, bent by a thousandth of "
        "its length in the shape of its first mode, and let go. Here it is a plate with free sides, as wide as the table says.",
        "The reference is that of a thin strip: shear and the inertia of turning lengthen it to 0.2702 s. Free sides lengthen it by 0.7 % "
        "more where the plate is only as wide as long: such a solid takes 0.2720 s, and springs 5.6 % less than that.",
        vibration.wide_strip,
        (springs(31, 31, 4), solid(0.25, 13, 31, 4)),
    ),
    Case(
        "Strip that falls in its own weight",
        "S. Turek, J. Hron 2006, case CSM3, [doi:10.1007/3-540-34596-5_15](https://doi.org/10.1007/3-540-34596-5_15), the row of 6468 "
        "unknowns and time steps of 5 ms, as [PVade](https://pvade.readthedocs.io) quotes it, whose own numbers are off by 3 to 8 %",
        "A strip of 0.35 x 0.02 m, 1.4 MPa, Poisson's ratio 0.4 and 1000 kg/m3 in plane strain is clamped at its end and let go under 2 "
        "m/s2. Here its sides are free, and it has the modulus of plane strain, E / (1 - nu2), with Poisson's ratio 0: the same for a "
        "thin strip in bending. Middle and amplitude are those of the extremes in 10 s; the way down is u_y.",
        "The source states no uncertainty. Its material is Saint Venant and Kirchhoff's, which differs from a neo-Hookean one at strains "
        "of some per cent.",
        bending.strip,
        (solid(0.0, 31, 4, 4),),
    ),
    Case(
        "Bar under its own weight",
        "case hangingBar of [solids4foam](https://www.solids4foam.com), whose finite volumes are off by 0.2 to 2 %",
        "A bar of 1 m, 210 GPa and 7800 kg/m3, 0.1 m thick, hangs in 9.80665 m/s2: elongation and stress at the top.",
        "The reference is that of one dimension, rho g L2 / (2 E) and rho g L, exact with Poisson's ratio 0; with another ratio the "
        "clamped end cannot contract, which makes the bar shorter by some 0.6 % at this thickness.",
        bars.hanging_bar,
        (springs(31, 4, 4), solid(0.0, 31, 4, 4), solid(0.3, 31, 4, 4)),
    ),
    Case(
        "Soft bar under its own weight",
        "test of [Newton](https://github.com/newton-physics/newton), pull request 2901",
        "A bar of 0.2 x 0.2 x 1 m with both constants of Lame 50 kPa (125 kPa, ratio 1/4) and 1000 kg/m3 hangs in 9.81 m/s2: elongation "
        "of its end.",
        "The reference, M g L / (2 A E), is that of small strains; here they are up to 8 %, and the source allows 4 %.",
        bars.soft_hanging_bar,
        (springs(16, 4, 4), solid(0.25, 16, 4, 4)),
    ),
    Case(
        "Bar that strikes a wall",
        "the wave equation in one dimension, in any textbook of impact",
        "A bar of 0.2 m, 1 MPa and 1000 kg/m3 meets a wall at 0.2 m/s: time of contact 2 L / c, force rho c A v while it lasts, and "
        "speed of rebound, where c is sqrt(E / rho).",
        "The reference is exact with Poisson's ratio 0. Contact is read every fiftieth of its time. A bar that vibrates after the impact "
        "leaves with less than its speed.",
        bars.striking_bar,
        (springs(31, 4, 4), solid(0.0, 31, 4, 4)),
    ),
    Case(
        "Sphere pressed into a block",
        "H. Hertz 1882, in K. L. Johnson, Contact Mechanics, chapter 4: 4/3 E / (1 - nu2) R1/2 d3/2",
        "A rigid sphere of R = 20 mm is pressed without friction into a cube of 40 mm of 1 MPa and Poisson's ratio 1/4, which is held "
        "below: force at rest at the depths d = 0.5, 1 and 2 mm. The reference is that of a half-space. The cube gives way less than that "
        "by 0.1088 F / (E 40 mm), 1.2, 1.7 and 2.4 % of d, after finite elements of another program for what is left beside Boussinesq's "
        "solution; the sphere goes less deep by it. Vertices of the surface are 0.75 mm apart.",
        "The reference is that of a paraboloid and of small strain; for a true sphere I. N. Sneddon's solution is 0.3, 0.5 and 1.0 % "
        "below it. The radius of the contact is 3.2, 4.5 and 6.3 mm, cells are 1.3 to 3.3 mm: errors are large where the contact is no "
        "larger than a cell, and fall with it. Twice the distance of the vertices lowers the finest solid's forces by 0.5 to 1.2 %. "
        "Springs, whose law at large strain is another, are too soft at the largest depth.",
        spheres.pressed_sphere,
        (*(springs(n, n, n) for n in (19, 31)), *(solid(0.25, n, n, n) for n in (13, 19, 31))),
    ),
    Case(
        "Sphere that hits a block",
        "H. Hertz 1882, in K. L. Johnson, Contact Mechanics, chapter 11: 2.87 (m2 / (R E*2 v))1/5 with E* = E / (1 - nu2)",
        "The same sphere, of 36.86 g, hits the same cube at 1 m/s: time of contact, largest force, and speed of rebound. The sphere moves "
        "in the host, which takes the reaction of each 400th of the time and gives back place and speed. The cube has 10 kg/m3 and drag, "
        "so that it follows without waves.",
        "The reference is the integral for this cube, which gives way by 0.1088 F / (E 40 mm) less than a half-space; that has 6.50 ms "
        "and 20.9 N. Contact is read every 400th of its time. Waves and drag take some of the speed: of the solid of 13 points a side "
        "1.6 %, and 0.04 % if the cube has 1 kg/m3.",
        spheres.hitting_sphere,
        (springs(19, 19, 19), solid(0.25, 13, 13, 13), solid(0.25, 19, 19, 19)),
    ),
    Case(
        "Bonded cube",
        "finite elements of another program, refined towards the edges until the numbers stand (`tests/data/solid.json` is of the same "
        "kind)",
        "A cube is bonded to two plates that press it by a millionth of its height: force by area and strain, divided by Young's modulus.",
        "The references are too large by at most 0.01, 0.1 and 0.25 % for the ratios 0.25, 0.45 and 0.49.",
        blocks.bonded_cube,
        (springs(7, 7, 7), *(solid(ratio, 7, 7, 7) for ratio in (0.25, 0.45, 0.49))),
    ),
    Case(
        "Bonded blocks of rubber",
        "A. N. Gent, P. B. Lindley 1959, Proceedings of the Institution of Mechanical Engineers 173, page 111",
        "Square blocks of Poisson's ratio 0.49 between bonded plates, of the shape factor S = side / (4 height), under small strain: "
        "their apparent modulus by Young's modulus.",
        "The reference is an approximation, 1 + 2 S2, for S = 2 with the bulk modulus in a row. Refined finite elements give the cube, S "
        "= 1/4, 1.22 at this ratio and 1.23 at 0.499, 8 to 10 % above it. Springs have Poisson's ratio 1/4 and no such stiffness.",
        blocks.bonded_block,
        (solid(0.49, 7, 7, 7), solid(0.49, 7, 13, 13), solid(0.49, 7, 25, 25), solid(0.49, 4, 25, 25)),
    ),
)
"""The published cases, in the order of the page"""
