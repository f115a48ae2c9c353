// A function of whoever calls, to be called during the call only: a pointer and a pointer. What takes one is compiled
// once, whatever it is given.
#pragma once

#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

namespace tachk::symbolic {

template <class Signature>
class Callback;

template <class Result, class... Arguments>
class Callback<Result(Arguments...)> {
 public:
  template <class Function>
    requires(!std::same_as<std::remove_cvref_t<Function>, Callback> &&
             std::is_invocable_r_v<Result, Function&, Arguments...>)
  Callback(Function&& function)  // NOLINT(bugprone-forwarding-reference-overload): it outlives the call
      : function_(const_cast<void*>(static_cast<const void*>(std::addressof(function)))),
        call_([](void* self, Arguments... arguments) -> Result {
          return (*static_cast<std::remove_reference_t<Function>*>(self))(std::forward<Arguments>(arguments)...);
        }) {}

  Result operator()(Arguments... arguments) const { return call_(function_, std::forward<Arguments>(arguments)...); }

 private:
  void* function_;
  Result (*call_)(void*, Arguments...);
};

}  // namespace tachk::symbolic
