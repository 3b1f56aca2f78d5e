/// A part that is made when it is first used: a part that a run never needs takes no memory.
#pragma once
#include <optional>
#include <utility>

namespace softffd {

template <class T>
class Lazy {
 public:
  /// Returns the part; the first call makes it of these arguments.
  template <class... Of>
  T& of(Of&&... parts) {
    return part_ ? *part_ : part_.emplace(std::forward<Of>(parts)...);
  }

 private:
  std::optional<T> part_;
};

}  // namespace softffd
