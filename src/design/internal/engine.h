#pragma once

#include <memory>

#include "zwidth/design/internal/evaluator.h"

namespace zwidth::internal {

/// A search algorithm, one generation at a time. A step that throws leaves the last whole generation as it was.
class Engine {
 public:
  virtual ~Engine() = default;

  /// Evaluates the first population. Throws `Stopped`.
  virtual void start() = 0;
  /// Makes the next generation. Throws `Stopped`, or what the algorithm throws when it cannot go on.
  virtual void step() = 0;
  /// There is nothing left to do.
  virtual bool done() const { return false; }
  /// Evaluations that the next step may need.
  virtual std::int64_t next_evaluations() const = 0;
  /// The last whole generation.
  virtual Rows rows() const = 0;

  /// All that the next step depends on, and back. A memory of another build may throw when it is taken.
  virtual std::string memory() const = 0;
  virtual void restore(const std::string& memory) = 0;
};

/// REQUIRES for both: nothing in `search_problems`, and that `evaluator` outlives the engine.
std::unique_ptr<Engine> make_pagmo_engine(const SearchOptions& options, Evaluator& evaluator);
std::unique_ptr<Engine> make_grid_engine(const SearchOptions& options, Evaluator& evaluator);

}  // namespace zwidth::internal
