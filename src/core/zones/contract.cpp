#include "zones/contract.hpp"

#include <cstdio>
#include <cstdlib>

namespace tachk::zones {
namespace {

void end_program(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: broken contract: %s\n", file, line, condition);
  std::abort();
}

}  // namespace

ContractHandler on_broken_contract = end_program;

}  // namespace tachk::zones
