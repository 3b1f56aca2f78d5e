/// A part that is made when it is first used: what a run never asks for takes no memory.
#pragma once
#include <optional>
#include <utility>

namespace softffd {

template <class T>
class Lazy {
 public:
  /// The part; the first time, made of these.
  template <class... Of>
  T& of(Of&&... parts) {
    return part_ ? *part_ : part_.emplace(std::forward<Of>(parts)...);
  }

 private:
  std::optional<T> part_;
};

}  // namespace softffd
