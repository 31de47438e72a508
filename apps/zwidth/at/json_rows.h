#pragma once

#include "context.h"

namespace zwidth::at {

/// A matrix as an array of rows; one that happens to have a single column too, which `json_array` takes for a
/// vector.
template <class Derived>
Json json_rows(const Eigen::MatrixBase<Derived>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(json_number(matrix(r, c)));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace zwidth::at
