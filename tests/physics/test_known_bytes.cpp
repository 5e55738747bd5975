#include <gtest/gtest.h>
#include <ode/ode.h>

#include "physics/collision/known_bytes.hpp"

namespace rdm {
namespace {

// Multiply-adds of ODE, one by one: each product rounds to 1, and a fused one keeps what it rounds away.
bool ode_is_fused() {
  const double a = 1 + 0x1p-30, b = 1 - 0x1p-30, c = 1 + 0x1p-29, d = 1 - 0x1p-29;
  const dQuaternion p = {a, c, 0, 0}, q = {b, d, 0, 0};
  dQuaternion product;
  dQMultiply0(product, p, q);
  return product[0] != 0;
}

// What the library says of its ODE is so, on a machine with a fused one too.
TEST(KnownBytes, OdeIsForeignWhereItFusesMultiplyAdds) {
  EXPECT_EQ(known_bytes().ode, !ode_is_fused());
}

TEST(KnownBytes, AreLookedForOnce) {
  EXPECT_EQ(&known_bytes(), &known_bytes());
}

}  // namespace
}  // namespace rdm
