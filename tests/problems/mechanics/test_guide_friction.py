"""Guide friction: series, limits, inverse relations and the first phase of engagement."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from synth.problems.mechanics import guide_friction as gf
from synth.problems.mechanics import ring

from synth.errors import InputError

ca.GlobalOptions.setNumpyMode(-1)  # as the engine does
QUICK = settings(deadline=None, derandomize=True, max_examples=80)
S_SERIES = ("geometric", "exponential_form", "lipka", "exponential_K")

kappas = st.floats(1e-4, 0.4)
even_counts = st.integers(1, 30).map(lambda n: 2 * n)


def pack_by_equilibrium(surfaces, kappa_a, kappa_b):
    """Contact forces for F0 = 1 from the axial equilibrium of every plate, as one linear system."""
    matrix, right = np.zeros((surfaces, surfaces)), np.zeros(surfaces)
    matrix[0, 0], right[0] = 1 + kappa_a, 1.0
    for plate in range(1, surfaces):
        kappa = kappa_b if plate % 2 else kappa_a
        # pushed by the force in front, held by the force behind and by guide friction of both faces
        matrix[plate, plate - 1], matrix[plate, plate] = 1 - kappa, -(1 + kappa)
    return np.linalg.solve(matrix, right)


@QUICK
@given(even_counts, kappas, kappas)
def test_exact_series_is_the_plate_by_plate_equilibrium(surfaces, kappa_a, kappa_b):
    forces = pack_by_equilibrium(surfaces, kappa_a, kappa_b)
    assert float(gf.sum_exact(surfaces, kappa_a, kappa_b)) == pytest.approx(forces.sum(), rel=1e-10)
    closed = [float(gf.contact_force("exact", 1.0, j, kappa_a, kappa_b)) for j in range(1, surfaces + 1)]
    np.testing.assert_allclose(closed, forces, rtol=1e-9)


@QUICK
@given(st.sampled_from(gf.GUIDE_SERIES), even_counts, kappas, kappas)
def test_contact_forces_add_up_to_the_torque(series, surfaces, kappa_a, kappa_b):
    forces = sum(float(gf.contact_force(series, 1.0, j, kappa_a, kappa_b)) for j in range(1, surfaces + 1))
    assert forces == pytest.approx(float(gf.torque_sum_factor(series, surfaces, kappa_a, kappa_b)), rel=1e-9)


@QUICK
@given(st.sampled_from(S_SERIES), st.integers(1, 40), kappas, kappas)
def test_contact_force_is_the_difference_of_the_sums(series, surface, kappa_a, kappa_b):
    step = gf.torque_sum_factor(series, surface, kappa_a, kappa_b) - gf.torque_sum_factor(
        series, surface - 1, kappa_a, kappa_b
    )
    assert float(gf.contact_force(series, 1.0, surface, kappa_a, kappa_b)) == pytest.approx(float(step), abs=1e-11)


@QUICK
@given(st.integers(1, 40), st.floats(1e-3, 1.0))
def test_geometric_series_term_by_term(surfaces, guide):
    assert float(gf.sum_geometric(surfaces, guide)) == pytest.approx(
        sum((1 + guide) ** -j for j in range(1, surfaces + 1)), rel=1e-9
    )
    assert float(gf.sum_geometric(surfaces, guide)) == pytest.approx(
        ((1 + guide) ** surfaces - 1) / (guide * (1 + guide) ** surfaces), rel=1e-9
    )


@QUICK
@given(even_counts, st.floats(1e-3, 0.4), st.floats(1e-3, 0.4))
def test_order_of_the_series(surfaces, kappa_a, kappa_b):
    five, five_a, lipka, ten, exact = (
        float(gf.torque_sum_factor(series, surfaces, kappa_a, kappa_b))
        for series in ("geometric", "exponential_form", "lipka", "exponential_K", "exact")
    )
    assert five == five_a
    assert five < lipka <= exact * (1 + 1e-14)
    assert exact < ten
    # exact and (5'') differ by terms of third order in S only: artanh k - k < k**3/(3 (1 - k**2))
    third_order = kappa_a**3 / (3 * (1 - kappa_a**2)) + kappa_b**3 / (3 * (1 - kappa_b**2))
    assert exact - lipka <= surfaces * third_order / (kappa_a + kappa_b) + 1e-12


@pytest.mark.parametrize("series", gf.GUIDE_SERIES)
@pytest.mark.parametrize("surfaces", [2, 10, 60])
def test_frictionless_guides_pass_the_whole_force(series, surfaces):
    assert float(gf.torque_sum_factor(series, surfaces, 0.0, 0.0)) == pytest.approx(surfaces, rel=1e-10)
    assert float(gf.contact_force(series, 800.0, surfaces, 0.0, 0.0)) == pytest.approx(800.0, rel=1e-10)
    for guide in (1e-13, 1e-11, 1e-9, 1e-7):
        second_order = surfaces * (1 - (surfaces + 1) * guide / 2)
        value = float(gf.torque_sum_factor(series, surfaces, guide / 2, guide / 2))
        assert value == pytest.approx(second_order, rel=2 * guide + 1e-9)


@QUICK
@given(st.sampled_from(gf.GUIDE_SERIES), even_counts, kappas, kappas)
def test_monotone(series, surfaces, kappa_a, kappa_b):
    value = float(gf.torque_sum_factor(series, surfaces, kappa_a, kappa_b))
    assert 0 < value < surfaces
    assert float(gf.torque_sum_factor(series, surfaces + 2, kappa_a, kappa_b)) >= value
    assert float(gf.torque_sum_factor(series, surfaces, kappa_a * 1.1, kappa_b)) <= value * (1 + 1e-13)
    assert float(gf.torque_sum_factor(series, surfaces, kappa_a, kappa_b * 1.1)) <= value * (1 + 1e-13)


@QUICK
@given(st.sampled_from(gf.GUIDE_SERIES), st.floats(0.02, 0.4), st.floats(0.02, 0.3), st.floats(0.03, 0.2))
def test_many_plates_saturate(series, mu, mu_guide, radius):
    force, a, b = 5000.0, 0.8 * radius, 1.3 * radius
    kappa_a, kappa_b = (gf.guide_ratio(mu, mu_guide, radius, x) for x in (a, b))
    ceiling = gf.torque_asymptote(force, mu_guide, a, b)
    torque = mu * force * radius * float(gf.torque_sum_factor(series, 1e6, kappa_a, kappa_b))
    overshoot = 1 + kappa_a + kappa_b if series == "exponential_K" else 1.0
    assert torque == pytest.approx(ceiling * overshoot, rel=1e-8)


@QUICK
@given(st.floats(1e-3, 2.0))
def test_lipka_ten_never_equals_five(guide):
    damped = gf.damped_guide_number(guide)
    excess = -((1 + guide) ** 2) * math.expm1(-damped) - guide
    assert excess > guide**3 / (1 + 2 * guide) * (1 - 1e-9) - 1e-15
    assert float(gf.exponential_k_error(1, guide)) > 0
    assert float(gf.exponential_k_error(1e7, guide)) == pytest.approx(guide, rel=1e-8)


@pytest.mark.parametrize(
    ("guide", "fifteen", "fourteen", "sixteen", "lipka"),
    [
        (0.01, 142.836, 160.956, 158.816, 159.362),
        (0.03, 48.5547, 54.7144, 52.5734, 53.1208),
        (0.0635, 23.6853, 26.6901, 24.5469, 25.0964),
        (0.1, 15.5563, 17.5299, 15.3844, 15.9362),
        (0.2, 8.48528, 9.56175, 7.41037, 7.96812),
    ],
)
def test_table_of_plate_limits(guide, fifteen, fourteen, sixteen, lipka):
    assert float(gf.legacy_plate_limit(guide)) == pytest.approx(fifteen, rel=4e-6)
    assert float(gf.surface_limit_exponential(guide)) == pytest.approx(fourteen, rel=4e-6)
    assert float(gf.surface_limit_geometric(guide)) == pytest.approx(sixteen, rel=4e-6)
    assert float(gf.surface_limit_lipka(guide)) == pytest.approx(lipka, rel=4e-6)


@QUICK
@given(st.floats(1e-3, 0.8), st.floats(0.1, 0.9))
def test_plate_limits_are_where_the_effectiveness_meets_the_threshold(guide, threshold):
    limits = {
        gf.sum_geometric: gf.surface_limit_geometric,
        gf.sum_lipka: gf.surface_limit_lipka,
        gf.sum_exponential_k: gf.surface_limit_exponential,
    }
    for series, limit in limits.items():
        found = float(limit(guide, threshold))

        def excess(z, series=series):
            return float(series(z, guide)) / z - threshold

        if excess(1e-6) <= 0:
            assert found <= 1e-5  # not even one surface reaches the threshold
        else:
            assert found == pytest.approx(brentq(excess, 1e-6, 1e6, xtol=1e-12), rel=1e-5)


def test_no_plate_is_allowed_where_no_root_exists():
    # ln(1.5)/(0.9 x 0.5) < 1
    assert float(gf.surface_limit_geometric(0.5, 0.9)) == 0.0


@pytest.mark.parametrize(
    "limit",
    [
        lambda symbol: gf.surface_limit_geometric(symbol),
        lambda symbol: gf.surface_limit_lipka(0.1, symbol),
        lambda symbol: gf.surface_limit_exponential(0.1, symbol),
    ],
)
def test_limits_of_surfaces_refuse_symbols(limit):
    """NumPy reads a symbol as not-a-number, of which the formula says that there is no limit."""
    with pytest.raises(TypeError, match="for numbers"):
        limit(ca.SX.sym("S"))


def test_fourteen_and_fifteen_differ_by_eleven_per_cent_and_the_appendix_by_sqrt_two():
    for guide in (0.01, 0.1, 0.4):
        damped = gf.damped_guide_number(guide)
        assert 1 - math.sqrt(2) / 1.5936243 == pytest.approx(0.113, abs=5e-4)
        assert float(gf.surface_limit_exponential(guide)) * damped == pytest.approx(1.5936243, rel=1e-7)
        assert float(gf.legacy_plate_limit(guide)) - math.sqrt(2) / guide == pytest.approx(math.sqrt(2), rel=1e-9)


@QUICK
@given(st.sampled_from(S_SERIES), st.floats(0.1, 0.95), st.integers(2, 40))
def test_guide_number_behind_a_surface_factor(series, factor, surfaces):
    guide = gf.guide_number_of_effectiveness(factor, surfaces, series)
    assert float(gf.torque_sum_factor(series, surfaces, guide, 0.0)) / surfaces == pytest.approx(factor, rel=1e-9)


SEED = {
    "inner_radius": 0.035,
    "outer_radius": 0.047,
    "inner_spline_radius": 0.032,
    "outer_spline_radius": 0.05,
    "mu": 0.1,
    "mu_guide": 0.3,
    "surfaces": 24.0,
    "force": 1000.0,
}


@QUICK
@given(
    st.sampled_from(gf.RELATION_VARIABLES),
    st.sampled_from(S_SERIES),
    st.floats(0.03, 0.3),
    st.floats(0.55, 0.95),
    st.floats(1.05, 1.6),
    st.floats(0.04, 0.3),
    st.floats(0.05, 0.4),
    st.floats(2, 30),
    st.floats(50, 1e5),
)
def test_every_unknown_of_the_relation(unknown, series, r2, inner, spline, mu, mu_guide, surfaces, force):
    clutch = {
        "inner_radius": inner * r2,
        "outer_radius": r2,
        "inner_spline_radius": 0.9 * inner * r2,
        "outer_spline_radius": spline * r2,
        "mu": mu,
        "mu_guide": mu_guide,
        "surfaces": surfaces,
        "force": force,
    }
    clutch["torque"] = gf.solve_relation("torque", series, **clutch)
    radius = ring.friction_radius((1 + inner) * r2, (1 - inner) / (1 + inner))
    guide = gf.guide_number(mu, mu_guide, radius, 0.9 * inner * r2, spline * r2)
    by_hand = mu * force * radius * float(gf.torque_sum_factor(series, surfaces, guide, 0.0))
    assert clutch["torque"] == pytest.approx(by_hand, rel=1e-12)
    # where the pack is saturated the torque no longer tells the unknown
    assume(float(gf.torque_sum_factor(series, surfaces, guide, 0.0)) * guide < 0.99)
    known = {name: value for name, value in clutch.items() if name != unknown}
    assert gf.solve_relation(unknown, series, **known) == pytest.approx(clutch[unknown], rel=1e-6)


def test_closed_forms_of_the_geometric_relation():
    """With q = M S/M0: z = -ln(1-q)/ln(1+S) and S = (1-q)**(-1/z) - 1."""
    torque = 45.0
    a, b, mu_guide, force = 0.032, 0.05, 0.3, 1000.0
    q = torque * mu_guide * (a + b) / (force * a * b)
    without_mu = {name: value for name, value in SEED.items() if name != "mu"} | {"torque": torque}
    guide = (1 - q) ** (-1 / 24) - 1
    radius = ring.friction_radius(0.082, 0.012 / 0.082)
    assert gf.solve_relation("mu", **without_mu) == pytest.approx(
        guide * a * b / (mu_guide * radius * (a + b)), rel=1e-9
    )
    without_z = {name: value for name, value in SEED.items() if name != "surfaces"} | {"torque": torque}
    guide = gf.guide_number(0.1, mu_guide, radius, a, b)
    assert gf.solve_relation("surfaces", **without_z) == pytest.approx(-math.log1p(-q) / math.log1p(guide), rel=1e-12)


def test_frictionless_guides_in_the_relation():
    free = SEED | {"mu_guide": 0.0}
    torque = gf.solve_relation("torque", **free)
    radius = ring.friction_radius(0.082, 0.012 / 0.082)
    assert torque == pytest.approx(0.1 * 1000 * radius * 24, rel=1e-9)
    known = {name: value for name, value in free.items() if name != "surfaces"}
    assert gf.solve_relation("surfaces", torque=torque, **known) == pytest.approx(24, rel=1e-9)


@pytest.mark.parametrize(
    ("unknown", "changes", "message"),
    [
        ("speed", {}, "unknown: got 'speed'; expected one of inner_radius"),
        ("torque", {"mu": -0.1}, "mu: got -0.1; expected a finite number above 0"),
        ("torque", {"mu": float("nan")}, "mu: got nan"),
        ("torque", {"mu": None}, "mu: is missing; expected a value, because torque is sought"),
        ("torque", {"inner_radius": 0.05}, "inner_radius: got 0.05; expected a radius below outer_radius"),
        ("surfaces", {"torque": 66.0}, "however many plates"),
        ("mu", {"torque": 66.0}, "however large mu r"),
        ("mu_guide", {"torque": 100.0}, "below mu F0 r z"),
        ("inner_spline_radius", {"torque": 53.0}, "inner_radius: got 0.035; expected a radius above"),
        ("inner_spline_radius", {"torque": 98.9}, "outer_spline_radius: got 0.05; expected a larger radius"),
        ("outer_spline_radius", {"torque": 20.0}, "outer_radius: got 0.047; expected a radius below"),
        ("inner_radius", {"torque": 30.0}, "outer_radius: got 0.047; expected a radius between"),
        ("outer_radius", {"torque": 30.0}, "inner_radius: got 0.035; expected a radius of at most"),
    ],
)
def test_relation_refuses(unknown, changes, message):
    known = {name: value for name, value in (SEED | changes).items() if name != unknown and value is not None}
    if unknown != "torque":
        known.setdefault("torque", 50.0)
    with pytest.raises(InputError, match=message):
        gf.solve_relation(unknown, **known)


def test_relation_needs_a_series_of_s_alone():
    with pytest.raises(InputError, match="a series that depends on S alone"):
        gf.solve_relation("torque", "exact", **SEED)
    without_z = {name: value for name, value in SEED.items() if name != "surfaces"}
    with pytest.raises(InputError, match="a series that depends on S alone"):
        gf.solve_relation("surfaces", "exact", torque=50.0, **without_z)
    with pytest.raises(InputError, match="guide_series: got 'cubic'"):
        gf.torque_sum_factor("cubic", 4, 0.1, 0.1)
    with pytest.raises(InputError, match="guide_series: got 'cubic'"):
        gf.contact_force("cubic", 1.0, 4, 0.1, 0.1)
    with pytest.raises(InputError, match=r"effectiveness: got 1\.2"):
        gf.guide_number_of_effectiveness(1.2, 10)
    with pytest.raises(InputError, match="a value that 1 surfaces of series exponential_K reach"):
        gf.guide_number_of_effectiveness(0.5, 1, "exponential_K")


@QUICK
@given(st.integers(1, 12), st.floats(0.05, 0.5), st.floats(0.05, 0.5), st.floats(0.5, 20))
def test_first_phase_of_any_number_of_plates(last, mu, mu_guide, weight):
    radius, a, b = 0.1, 0.09, 0.12
    weights = [weight * (1 + 0.1 * plate) for plate in range(last + 1)]
    push = float(gf.first_phase_push_force(weights, mu, mu_guide, radius, a, b))
    # forces in front of each plate, as one linear system: N_j - N_(j+1) = mu1 G_j + kappa_j (N_j + N_(j+1))
    matrix, right = np.zeros((last + 1, last + 1)), np.array([mu_guide * g for g in weights])
    for plate in range(last + 1):
        kappa = mu * mu_guide * radius / (b if plate % 2 else a)
        matrix[plate, plate] = 1.0 if plate == 0 else 1 - kappa
        if plate < last:
            matrix[plate, plate + 1] = -(1 + kappa)
    assert push == pytest.approx(np.linalg.solve(matrix, right)[0], rel=1e-10)
    assert push > mu_guide * sum(weights)


def test_first_phase_of_the_source():
    """f_I = G_I mu1 b/(b - mu mu1 r), extra for plate 0: f_I mu mu1 r/a + G_0 mu1."""
    mu, mu1, r, a, b, g0, g1 = 0.12, 0.25, 0.041, 0.032, 0.05, 2.0, 2.6
    f1 = g1 * mu1 * b / (b - mu * mu1 * r)
    expected = f1 + f1 * mu * mu1 * r / a + g0 * mu1
    assert gf.first_phase_push_force([g0, g1], mu, mu1, r, a, b) == pytest.approx(expected, rel=1e-13)
    assert gf.first_phase_push_force([g0], mu, mu1, r, a, b) == pytest.approx(mu1 * g0, rel=1e-13)


def test_jam_is_where_the_push_force_becomes_infinite():
    b = 0.5 * 0.5 * 0.2
    assert gf.guide_jams(0.5, 0.5, 0.2, b * (1 - 1e-9))
    assert not gf.guide_jams(0.5, 0.5, 0.2, b * (1 + 1e-9))
    near, nearer = (gf.first_phase_push_force([1.0, 1.0], 0.5, 0.5, 0.2, 1.0, b * (1 + e)) for e in (1e-4, 1e-6))
    assert nearer > 90 * near
    assert list(gf.guide_jams(np.array([0.1, 0.9]), 0.9, 0.1, 0.05)) == [False, True]
