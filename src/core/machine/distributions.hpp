// Random numbers by distributions that models name, made of uniform ones. For parameters that a distribution does not
// have they are not a number.
#pragma once

#include "machine/floating.hpp"

namespace tachk::machine {

// By the operation, one of those that draw.
double drawn(FloatingOperation operation, double left, double right, Dice& dice);

}  // namespace tachk::machine
