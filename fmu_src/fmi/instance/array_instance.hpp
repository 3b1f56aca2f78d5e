/// Instances as FMI 3.0 has them: their variables are arrays, and time is one of them.
#pragma once
#include <unordered_map>

extern "C" {
#include "fmi3FunctionTypes.h"
}

#include "instance/instance.hpp"

namespace softffd::fmi {

class ArrayInstance : public Instance {
 public:
  ArrayInstance(SceneFile scene, Logger logger);

  static constexpr fmi3ValueReference time = 0;  ///< no family has the id 0

  /// One call of the standard for values of variables: the variables, and how many values the host has room for.
  struct Call {
    const fmi3ValueReference* references;
    std::size_t count;
    std::size_t values;
  };

  /// The number of values that the call is about. All throw CallError for references that there are not and another number of values.
  std::size_t size_of(const Call& call) const;
  /// Sets all or nothing.
  void get_arrays(Type type, const Call& call, double* values);
  void set_arrays(Type type, const Call& call, const double* values);
  void get_array_derivatives(const Call& call, const fmi3Int32* orders, double* values);

 private:
  using Array = Variables::Array;
  const Array& array(fmi3ValueReference reference) const;
  /// Calls each(array, its first value's place, number of the variable).
  template <class Each>
  void for_each(const Call& call, Each&& each) const;

  std::unordered_map<fmi3ValueReference, Array> arrays_;
};

}  // namespace softffd::fmi
