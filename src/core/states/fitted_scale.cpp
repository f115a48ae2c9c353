#include "states/fitted_scale.hpp"

namespace tachk::states {

FittedScale::FittedScale(const zones::ZoneOperations& operations, int dimension)
    : operations_(operations), dimension_(dimension), scale_(zones::choose_scale(operations, dimension, 0)) {}

bool FittedScale::admit(zones::Raw largest_entry) {
  ++zones_;
  if (largest_entry <= range_) return false;
  range_ = largest_entry + largest_entry / 2;
  scale_ = scale_of(cut_);
  return true;
}

bool FittedScale::choose(unsigned cut) {
  if (cut == cut_) return false;
  cut_ = cut;
  scale_ = scale_of(cut);
  return true;
}

zones::ExtentScale FittedScale::scale_of(unsigned cut) const {
  return zones::choose_scale(operations_, dimension_, range_ >> cut);
}

}  // namespace tachk::states
