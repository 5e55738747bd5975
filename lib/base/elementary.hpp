// Sine, exponential and their kin out of + - * / and sqrt alone: the same bits on every machine, whatever
// mathematics library it has.
//
// Errors are in units in the last place (ulp) of the exact result, rounding to nearest. Not-a-number gives
// not-a-number; +-0 and infinities give what C gives for them. Subnormal results may be 0.
#pragma once
#include <cstdint>

namespace rdm::elementary {

struct SinCos {
  double sin, cos;
};

// x in rad. Below 1 ulp for |x| <= 1600; beyond that, the values for an argument within half a ulp of x, so
// finite for every finite x. Not-a-number for infinities.
SinCos sincos(double x);
double sin(double x);
double cos(double x);

// Below 1 ulp. 0 where the result would be under 2^-1022.
double exp(double x);

// e^x - 1. Below 2 ulp.
double expm1(double x);

// Natural logarithm. Below 1 ulp. A subnormal x counts as 0; not-a-number for x < 0.
double log(double x);

// log(1 + x). Below 2 ulp. Not-a-number for x < -1.
double log1p(double x);

// Angle of the point (x, y), rad, in [-pi, pi]. Below 2 ulp.
double atan2(double y, double x);

// rad, in [-pi/2, pi/2]. Below 2.5 ulp. Not-a-number for |x| > 1.
double asin(double x);

// x to the n-th by squaring, n >= 0. Relative error below n 2^-53.
double pow(double x, int64_t n);

}  // namespace rdm::elementary
