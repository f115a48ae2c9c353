// The discrete parts of states: bit-packed, each held once. Where they are large they are held as lists of chunks, each
// chunk held once, because most chunks of a successor are those of its predecessor (the collapse method of SPIN:
// Holzmann, "State compression in SPIN", 1997).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "program/program.hpp"
#include "states/memory.hpp"

namespace tachk::states {

// Packs the slots of a state into 64-bit words; a slot with one legal value takes no bits, no slot crosses a word.
class StateLayout {
 public:
  explicit StateLayout(const program::Program& program);

  std::size_t words() const { return words_; }
  // Of all words together, without what is free at the end of the last one.
  std::size_t bits() const { return bits_; }
  std::size_t slots() const { return initial_.size(); }
  // The initial values of the slots, which those keep that live in no word.
  const std::vector<std::int32_t>& initial() const { return initial_; }
  // Packs the slots that live in the words [first, last) into words[0], words[1], ...
  void pack(const std::int32_t* slots, std::size_t first, std::size_t last, std::uint64_t* words) const;
  // Fills the slots that live in the words [first, last), given as words[0], words[1], ...
  void unpack(const std::uint64_t* words, std::size_t first, std::size_t last, std::int32_t* slots) const;
  // The first slot behind those of the words in front of `word`.
  std::size_t first_slot(std::size_t word) const;

 private:
  struct Field {
    std::uint32_t slot;
    std::uint32_t word;
    std::uint32_t shift;
    std::uint64_t mask;
    std::int32_t low;
  };
  std::vector<Field> fields_;
  std::vector<std::size_t> first_field_;  // of each word, and behind the last
  std::vector<std::int32_t> initial_;
  std::size_t words_ = 1;
  std::size_t bits_ = 0;
};

class DiscreteStates {
 public:
  // States of more than two chunks are held as lists of chunks; with 0 words to a chunk none are.
  DiscreteStates(const program::Program& program, std::size_t chunk_words);

  // Sets the discrete state that the next `locate` looks up; all slots in which it differs from the state unpacked last
  // are in `written`. Call it early, so that its memory is fetched in the meantime.
  void announce(const std::int32_t* slots, const program::SlotSet& written);
  // The number of that state, which is new, with the note `fresh_note`, if it was never looked up before.
  std::uint32_t locate(std::uint32_t fresh_note);
  bool equals(std::uint32_t number, const std::int32_t* slots);
  void unpack(std::uint32_t number, std::int32_t* slots);

  // How many there are.
  std::uint32_t size() const { return records_.size(); }

  // A number kept for each discrete state.
  std::uint32_t& note(std::uint32_t number) { return *reinterpret_cast<std::uint32_t*>(records_[number]); }
  std::uint32_t note(std::uint32_t number) const { return *reinterpret_cast<const std::uint32_t*>(records_[number]); }
  std::size_t bytes() const { return records_.bytes() + index_.bytes() + chunks_.bytes() + chunk_index_.bytes(); }

 private:
  static constexpr std::size_t note_bytes = sizeof(std::uint32_t);
  const std::byte* key_of(std::uint32_t number) const { return records_[number] + note_bytes; }
  // The key of the announced state as records hold it.
  const void* held_key() const {
    return narrow_key_.empty() ? static_cast<const void*>(key_.data()) : narrow_key_.data();
  }
  bool has_key(std::uint32_t number) const { return std::memcmp(key_of(number), held_key(), key_bytes_) == 0; }
  // Writes to the key what stands for a state in its record: the packed words, or the numbers of its chunks.
  void make_key(const std::int32_t* slots, const program::SlotSet& written);
  // The number of the chunk that `packed_` holds.
  std::uint32_t intern_chunk();
  std::uint32_t chunk_number(const std::byte* key, std::size_t chunk) const;
  // Numbers of chunks have 16 bits in records, and more once there are too many chunks for that.
  void widen_numbers();

  StateLayout layout_;
  std::size_t chunk_words_;  // 0: states are held whole
  std::size_t key_bytes_;    // of the words of a key those that are held, the others are 0: whole numbers of 32 bits
  std::vector<std::uint64_t> key_;     // of the announced state; numbers of chunks have 32 bits
  std::uint64_t hash_ = 0;             // of that key
  std::vector<std::uint64_t> packed_;  // one chunk, or a state that is held whole
  RecordPool records_;                 // keys as they are held, each behind its note
  HashIndex index_;

  // Only for states in chunks.
  std::vector<std::size_t> chunk_slots_;  // the first slot of each chunk, and behind the last
  std::vector<program::SlotSet> chunk_members_;
  RecordPool chunks_;
  HashIndex chunk_index_;
  std::vector<std::uint16_t> narrow_key_;  // the key with numbers of 16 bits; empty once they have more
  // The state unpacked last and its chunks: a successor has most of them.
  std::vector<std::int32_t> known_slots_;
  std::vector<std::uint32_t> known_chunks_;
};

}  // namespace tachk::states
