// math/contact.glsl: the first time at which a ray whose clearance is a quadratic touches the ground.
// Clearance: height of the ray above a surface, s after the ray entered the piece of surface in question. A straight ray over
// a bilinear patch, a bent ray over a column and a bent ray over a bilinear patch all have a clearance of this form.
// Units: heights in codes, s in metres of view depth; any others do as well.
#ifndef TERRAY_MATH_CONTACT
#define TERRAY_MATH_CONTACT
#include "math/portable.glsl"

// clearance(s) = (bend * s + slope) * s + start
struct Clearance {
    real bend;
    real slope;
    real start;
};

MATH_FUNCTION real clearanceAt(Clearance clearance, real s) {
    return (clearance.bend * s + clearance.slope) * s + clearance.start;
}

// The first s in [0, span] with clearance(s) <= 0, or -1 when there is none.
//
// What decides is the sign at both ends, so neighbouring pieces cannot both let a ray through: a ray that leaves this piece
// below the surface touches here, and one that enters it below (start <= 0) touches at 0, whatever rounding did before.
// Only a ray that dips below and comes up again within the piece depends on the discriminant. Both roots are taken in the
// form that adds numbers of one sign: a bend near 0, a double root and a start near 0 lose no digits.
// Source: Press et al. 2007, "Numerical Recipes", 3rd edition, section 5.6.
MATH_FUNCTION real firstContact(Clearance clearance, real span) {
    const real none = -REAL(1.0);
    if (clearance.start <= REAL(0.0)) return REAL(0.0);
    bool below = clearanceAt(clearance, span) <= REAL(0.0);
    bool dips = clearance.slope < REAL(0.0) && -clearance.slope < REAL(2.0) * clearance.bend * span;
    if (!below && !dips) return none;

    real discriminant = clearance.slope * clearance.slope - REAL(4.0) * clearance.bend * clearance.start;
    if (discriminant < REAL(0.0) && !below) return none;
    real root = sqrt(max(discriminant, REAL(0.0)));
    // Falling from the start: the smaller positive root. Else the ground rises to meet the ray, bend < 0: the only one.
    real s = clearance.slope < REAL(0.0) ? REAL(2.0) * clearance.start / (root - clearance.slope)
                                         : (root + clearance.slope) / max(-REAL(2.0) * clearance.bend, REAL(1e-37));
    return max(REAL(0.0), min(s, span));
}

// When a ray that starts below (start < 0) and bends up (bend >= 0, not level with bend 0) comes up through the surface; beyond any
// span if never.
MATH_FUNCTION real riseTime(Clearance clearance) {
    real root = sqrt(clearance.slope * clearance.slope - REAL(4.0) * clearance.bend * clearance.start);
    real tiny = REAL(1e-37);
    return clearance.slope > REAL(0.0)
               ? -REAL(2.0) * clearance.start / (root + clearance.slope)
               : (root - clearance.slope) / max(REAL(2.0) * clearance.bend, tiny);
}

#endif
