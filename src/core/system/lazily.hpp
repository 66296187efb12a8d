// A value of an immutable object that is made at the first need, once, whichever thread asks.
#pragma once
#include <mutex>
#include <optional>

namespace sysid {

/// A copy makes its own.
template <class T>
class Lazily {
 public:
  Lazily() = default;
  Lazily(Lazily const&) {}
  Lazily& operator=(Lazily const&) { return *this; }

  template <class Make>
  T const& get(Make const& make) const {
    std::call_once(made_, [&] { value_.emplace(make()); });
    return *value_;
  }

 private:
  mutable std::once_flag made_;
  mutable std::optional<T> value_;
};

}  // namespace sysid
