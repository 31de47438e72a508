#include "zwidth/ranks/ranks.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <memory>
#include <mpi.h>
#include <sched.h>
#include <stdexcept>
#include <thread>

namespace zwidth {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWork = 1;     // first row, then designs
constexpr int kOutcome = 2;  // first row, 1 if it was told to stop, then outcomes
constexpr int kHome = 3;     // nothing more to do
constexpr std::size_t kWorkHead = 1, kOutcomeHead = 2;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Below, sending rows away takes longer than evaluating them.
constexpr double kWorthSending = 100e-6;  // [s]
constexpr double kWorthAMessage = 10e-6;  // [s]
// Open MPI's shared memory passes up to 4 KiB on at once, its header included; networks take more. The sender
// of a longer message waits until the other side asks for it, which is when that has done the rows it is at.
constexpr std::size_t kAtOnce = (4096 - 256) / sizeof(double);  // values in a message

// MPI's own waiting keeps a core busy, which another rank may need. This one yields at first, then sleeps for
// a share of the time waited so far: what is late by that is little beside the wait.
MPI_Status wait_for_message() {
  constexpr auto kSpin = std::chrono::microseconds(100);
  constexpr auto kLongest = std::chrono::milliseconds(2);
  const auto start = Clock::now();
  for (;;) {
    int arrived = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &arrived, &status);
    if (arrived != 0) return status;
    const auto waited = Clock::now() - start;
    if (waited < kSpin) {
      sched_yield();
    } else {
      std::this_thread::sleep_for(std::min<Clock::duration>(waited / 32, kLongest));
    }
  }
}

// The message that was announced.
void receive(const MPI_Status& announced, std::vector<double>& message) {
  int count = 0;
  MPI_Get_count(&announced, MPI_DOUBLE, &count);
  message.resize(static_cast<std::size_t>(count));
  MPI_Recv(message.data(), count, MPI_DOUBLE, announced.MPI_SOURCE, announced.MPI_TAG, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
}

/// Messages on their way. MPI's own blocking send may wait until the other side has done the rows it is at.
class Outbox {
 public:
  /// An empty message to fill.
  std::vector<double>& next() {
    for (at_ = 0; at_ < sent_.size(); ++at_) {
      int gone = 0;
      MPI_Test(&sent_[at_].request, &gone, MPI_STATUS_IGNORE);
      if (gone != 0) break;
    }
    if (at_ == sent_.size()) sent_.emplace_back();
    sent_[at_].values.clear();
    return sent_[at_].values;
  }

  /// Sends the message that `next` gave last.
  void send(int to, int tag) {
    Message& one = sent_[at_];
    MPI_Isend(one.values.data(), static_cast<int>(one.values.size()), MPI_DOUBLE, to, tag, MPI_COMM_WORLD,
              &one.request);
  }

  /// Waits until all have gone.
  void empty() {
    for (Message& one : sent_) MPI_Wait(&one.request, MPI_STATUS_IGNORE);
  }

 private:
  struct Message {
    std::vector<double> values;
    MPI_Request request = MPI_REQUEST_NULL;
  };
  std::vector<Message> sent_;
  std::size_t at_ = 0;
};

/// One batch, as rank 0 deals it out.
class Dealer {
 public:
  Dealer(std::size_t variables, std::size_t outcomes, BatchEvaluation own, int ranks)
      : variables_(variables),
        outcomes_(outcomes),
        most_(std::max<std::size_t>(
            1, std::min((kAtOnce - kWorkHead) / variables, (kAtOnce - kOutcomeHead) / outcomes))),
        own_(std::move(own)),
        ranks_(ranks) {}

  bool evaluate(std::span<const double> designs, std::span<double> rows) {
    const std::size_t count = rows.size() / outcomes_;
    if (ranks_ == 1 || count < 2 || (cost_ > 0.0 && cost_ * static_cast<double>(count) < kWorthSending)) {
      const auto start = Clock::now();
      const bool whole = own_(designs, rows);
      learn_cost(start, count);
      return whole;
    }
    designs_ = designs;
    rows_ = rows;
    count_ = count;
    next_ = 0;
    outstanding_ = 0;
    stopped_ = false;
    // Two pieces each, so that nobody waits for the answer to the first one.
    for (int piece = 0; piece < 2; ++piece) {
      for (int rank = 1; rank < ranks_; ++rank) deal(rank);
    }
    while (next_ < count_ || outstanding_ > 0) {
      collect(false);
      if (next_ < count_) {
        do_own_piece();
      } else if (outstanding_ > 0) {
        collect(true);
      }
    }
    return !stopped_;
  }

 private:
  // Pieces shrink towards the end, where a large one would keep the others waiting.
  std::size_t next_piece() const {
    const std::size_t left = count_ - next_;
    const std::size_t share = left / (4 * static_cast<std::size_t>(ranks_));
    const auto least = cost_ > 0.0 ? static_cast<std::size_t>(kWorthAMessage / cost_) : std::size_t{1};
    return std::min({left, most_, std::max({std::size_t{1}, share, std::min(least, left / 2)})});
  }

  void deal(int rank) {
    if (next_ >= count_) return;
    const std::size_t piece = next_piece();
    const auto part = designs_.subspan(next_ * variables_, piece * variables_);
    std::vector<double>& work = outbox_.next();
    work.push_back(static_cast<double>(next_));
    work.insert(work.end(), part.begin(), part.end());
    outbox_.send(rank, kWork);
    next_ += piece;
    ++outstanding_;
  }

  void do_own_piece() {
    const std::size_t first = next_, piece = next_piece();
    next_ += piece;
    const auto start = Clock::now();
    try {
      if (!own_(designs_.subspan(first * variables_, piece * variables_),
                rows_.subspan(first * outcomes_, piece * outcomes_))) {
        stop();
      }
    } catch (...) {
      // The others must not be left with answers that nobody takes.
      stop();
      while (outstanding_ > 0) collect(true);
      throw;
    }
    learn_cost(start, piece);
  }

  void collect(bool wait) {
    for (;;) {
      MPI_Status status;
      if (wait) {
        status = wait_for_message();
        wait = false;
      } else {
        int arrived = 0;
        MPI_Iprobe(MPI_ANY_SOURCE, kOutcome, MPI_COMM_WORLD, &arrived, &status);
        if (arrived == 0) return;
      }
      receive(status, message_);
      --outstanding_;
      const auto first = static_cast<std::ptrdiff_t>(message_[0]);
      if (message_[1] != 0.0) stop();
      std::copy(message_.begin() + kOutcomeHead, message_.end(),
                rows_.begin() + first * static_cast<std::ptrdiff_t>(outcomes_));
      deal(status.MPI_SOURCE);
    }
  }

  void stop() {
    stopped_ = true;
    next_ = count_;
  }

  void learn_cost(Clock::time_point start, std::size_t rows) {
    if (rows > 0) {
      cost_ = std::chrono::duration<double>(Clock::now() - start).count() / static_cast<double>(rows);
    }
  }

  std::size_t variables_, outcomes_;
  std::size_t most_;  // rows in a piece
  BatchEvaluation own_;
  int ranks_;
  double cost_ = 0.0;  // of a row on this rank [s]; 0 before the first. Steers only who does what.
  Outbox outbox_;
  std::vector<double> message_;  // the latest that came
  // The batch at hand.
  std::span<const double> designs_;
  std::span<double> rows_;
  std::size_t count_ = 0, next_ = 0;  // rows, and the first that nobody has
  int outstanding_ = 0;               // pieces that others have
  bool stopped_ = false;
};

}  // namespace

bool Ranks::started_by_launcher() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

Ranks::Ranks() {
  int started = 0;
  MPI_Initialized(&started);
  if (started != 0) throw std::runtime_error("MPI was started before");
  int given = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given) != MPI_SUCCESS) {
    throw std::runtime_error("MPI cannot be started");
  }
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Ranks::~Ranks() {
  if (drives()) {
    for (int rank = 1; rank < size_; ++rank) MPI_Send(nullptr, 0, MPI_DOUBLE, rank, kHome, MPI_COMM_WORLD);
  } else if (!sent_home_) {
    std::vector<double> nothing;
    receive(wait_for_message(), nothing);
  }
  MPI_Finalize();
}

int Ranks::first_that(bool yes) const {
  const int mine = yes ? rank_ : size_;
  int first = size_;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return first;
}

BatchEvaluation Ranks::spread(std::size_t variables, std::size_t outcomes, BatchEvaluation own) {
  assert(drives() && variables > 0 && outcomes > 0);
  auto dealer = std::make_shared<Dealer>(variables, outcomes, std::move(own), size_);
  return [dealer](std::span<const double> designs, std::span<double> rows) {
    return dealer->evaluate(designs, rows);
  };
}

void Ranks::serve(std::size_t variables, std::size_t outcomes, const BatchEvaluation& own) {
  assert(!drives() && variables > 0 && outcomes > 0);
  Outbox outbox;
  std::vector<double> work;
  for (;;) {
    const MPI_Status status = wait_for_message();
    receive(status, work);
    if (status.MPI_TAG == kHome) {
      sent_home_ = true;
      outbox.empty();
      return;
    }
    const std::span<const double> designs = std::span<const double>(work).subspan(kWorkHead);
    const std::size_t count = designs.size() / variables;
    std::vector<double>& answer = outbox.next();
    answer.assign(kOutcomeHead + count * outcomes, kNaN);
    answer[0] = work[0];
    const std::span<double> rows = std::span<double>(answer).subspan(kOutcomeHead);
    bool whole = true;
    try {
      whole = own(designs, rows);
    } catch (...) {
      // One by one, so that what throws costs only its own row.
      for (std::size_t row = 0; row < count; ++row) {
        const std::span<double> one = rows.subspan(row * outcomes, outcomes);
        std::fill(one.begin(), one.end(), kNaN);
        try {
          whole = own(designs.subspan(row * variables, variables), one) && whole;
        } catch (...) {
          std::fill(one.begin(), one.end(), kNaN);
        }
      }
    }
    answer[1] = whole ? 0.0 : 1.0;
    outbox.send(0, kOutcome);
  }
}

}  // namespace zwidth
