// Contracts: what an operation asks of its arguments and promises of its result, checked where it is called. They are
// compiled in with TACHK_CONTRACTS only (the presets core, core-asan and checked); elsewhere they cost nothing.
#pragma once

namespace tachk::zones {

// Called with the condition that does not hold, in the words of the source, and its place. Prints them and ends the
// program, unless a test has put something else here.
using ContractHandler = void (*)(const char* condition, const char* file, int line);
extern ContractHandler on_broken_contract;

}  // namespace tachk::zones

#ifdef TACHK_CONTRACTS
#define TACHK_EXPECT(condition) \
  static_cast<void>((condition) || (::tachk::zones::on_broken_contract(#condition, __FILE__, __LINE__), true))
#else
#define TACHK_EXPECT(condition) static_cast<void>(0)
#endif
