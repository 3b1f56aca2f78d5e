/// Instances of FMI 3.0: their variables are arrays, and time is one of the variables.
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

  /// Arguments of a call that gets or sets variables: value references, their number, and the number of values that the host passes.
  struct Call {
    const fmi3ValueReference* references;
    std::size_t count;
    std::size_t values;
  };

  /// Returns the number of values of the call. All functions throw CallError for unknown references and for a wrong number of values.
  std::size_t size_of(const Call& call) const;
  /// `set_arrays` sets all values or none.
  void get_arrays(Type type, const Call& call, double* values);
  void set_arrays(Type type, const Call& call, const double* values);
  void get_array_derivatives(const Call& call, const fmi3Int32* orders, double* values);

 private:
  using Array = Variables::Array;
  const Array& array(fmi3ValueReference reference) const;
  /// Calls each(value references of the elements, index of the first value, index of the variable in the call).
  template <class Each>
  void for_each(const Call& call, Each&& each) const;

  std::unordered_map<fmi3ValueReference, Array> arrays_;
};

}  // namespace softffd::fmi
