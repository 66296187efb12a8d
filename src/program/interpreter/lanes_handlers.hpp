// The handlers of the lane executors, for whichever instruction set's vector type the including file defines. Each includes it in
// an anonymous namespace, so that the linker can never take one set's code for the other's.
//
// A handler does one instruction for all vectors of a block and jumps to the next handler (the compiler makes the call in tail
// position a jump). The accumulator, one vector per parameter of the handler, stays in machine registers on the way: most
// intermediate results are used by the next instruction alone and never touch memory.
//
// No include guard and no includes: the including file provides Step, InstructionShape, OperandPlace, Opcode and
//   Vec, vector_lanes, load, store, broadcast, zero, one, negate_of, add_of, ... (see below for their uses).

// Where an operand is read; a uniform is broadcast once for all vectors of the block.
struct Lane {
  Lane(char const* file, unsigned offset) : row(file + offset) {}
  Vec at(int i, Vec) const { return load(row + i * vector_bytes); }
  char const* row;
};
struct Uniform {
  Uniform(char const* file, unsigned offset) : value(broadcast(file + offset)) {}
  Vec at(int, Vec) const { return value; }
  Vec value;
};
struct Accumulator {
  Accumulator(char const*, unsigned) {}
  Vec at(int, Vec accumulator) const { return accumulator; }
};
using None = Accumulator;

struct Move {
  static Vec of(Vec a, Vec, Vec) { return a; }
};
struct Negate {
  static Vec of(Vec a, Vec, Vec) { return negate_of(a); }
};
struct Add {
  static Vec of(Vec a, Vec b, Vec) { return add_of(a, b); }
};
struct Subtract {
  static Vec of(Vec a, Vec b, Vec) { return subtract_of(a, b); }
};
struct Multiply {
  static Vec of(Vec a, Vec b, Vec) { return multiply_of(a, b); }
};
struct Divide {
  static Vec of(Vec a, Vec b, Vec) { return divide_of(a, b); }
};
struct Fused {
  static Vec of(Vec a, Vec b, Vec c) { return fused_of(a, b, c); }
};
struct FusedSubtract {
  static Vec of(Vec a, Vec b, Vec c) { return fused_subtract_of(a, b, c); }
};
struct FusedNegate {
  static Vec of(Vec a, Vec b, Vec c) { return fused_negate_of(a, b, c); }
};
struct FusedBoth {
  static Vec of(Vec a, Vec b, Vec c) { return fused_both_of(a, b, c); }
};
struct SquareRoot {
  static Vec of(Vec a, Vec, Vec) { return square_root_of(a); }
};
struct Absolute {
  static Vec of(Vec a, Vec, Vec) { return absolute_of(a); }
};
struct Sign {
  static Vec of(Vec a, Vec, Vec) { return subtract_of(less_of(zero(), a), less_of(a, zero())); }
};
struct Minimum {
  static Vec of(Vec a, Vec b, Vec) { return minimum_of(a, b); }
};
struct Maximum {
  static Vec of(Vec a, Vec b, Vec) { return maximum_of(a, b); }
};
struct Floor {
  static Vec of(Vec a, Vec, Vec) { return floor_of(a); }
};
struct Less {
  static Vec of(Vec a, Vec b, Vec) { return less_of(a, b); }
};
struct LessEqual {
  static Vec of(Vec a, Vec b, Vec) { return less_equal_of(a, b); }
};
struct Equal {
  static Vec of(Vec a, Vec b, Vec) { return equal_of(a, b); }
};
struct Conjunction {
  static Vec of(Vec a, Vec b, Vec) { return both_of(a, b); }
};
struct Disjunction {
  static Vec of(Vec a, Vec b, Vec) { return either_of(a, b); }
};
struct Negation {
  static Vec of(Vec a, Vec, Vec) { return equal_of(a, zero()); }
};
struct Select {
  static Vec of(Vec a, Vec b, Vec c) { return select_of(a, b, c); }
};

template <int>
using Each = Vec;

/// The executor of blocks of sizeof...(I) vectors.
template <int... I>
struct Machine {
  using Run = void (*)(Step const*, char*, Each<I>...);

  static void go_on(Step const* step, char* file, Each<I>... accumulator) {
    return reinterpret_cast<Run>(step->handler)(step, file, accumulator...);
  }

  // Vectors come as arguments, for which the compiler expects the caller to have more to do with them: it would leave their upper
  // halves as they are, and until these are cleared all that is compiled for narrower vectors takes several times as long.
  static void end(Step const*, char*, Each<I>...) { leave(); }

  template <class Operation, bool keep, class A, class B, class C>
  static Vec one_vector(A a, B b, C c, char* target, int i, Vec accumulator) {
    Vec const result = Operation::of(a.at(i, accumulator), b.at(i, accumulator), c.at(i, accumulator));
    if (keep) store(target + i * vector_bytes, result);
    return result;
  }

  template <class Operation, bool keep, class A, class B, class C>
  static void arithmetic(Step const* step, char* file, Each<I>... accumulator) {
    A const a(file, step->a);
    B const b(file, step->bc[0]);
    C const c(file, step->bc[1]);
    char* const target = file + step->target;
    Run const next = reinterpret_cast<Run>(step[1].handler);
    return next(step + 1, file, one_vector<Operation, keep>(a, b, c, target, I, accumulator)...);
  }

  static constexpr int width = static_cast<int>(sizeof...(I)) * vector_lanes;

  static void call_unary(Step const* step, char* file, Each<I>...) {
    step->unary(reinterpret_cast<double const*>(file + step->a), reinterpret_cast<double*>(file + step->target), width);
    return go_on(step + 1, file, load(file + step->target + I * vector_bytes)...);
  }

  static void call_binary(Step const* step, char* file, Each<I>...) {
    step[1].binary(reinterpret_cast<double const*>(file + step->a), reinterpret_cast<double const*>(file + step->bc[0]),
                   reinterpret_cast<double*>(file + step->target), width);
    return go_on(step + 2, file, load(file + step->target + I * vector_bytes)...);
  }

  // The choice of a handler: one function per kind of instruction, one branch per place of an operand.
  template <class Operation, class A, class B, class C>
  static Handler stored(bool keep) {
    return keep ? reinterpret_cast<Handler>(&arithmetic<Operation, true, A, B, C>)
                : reinterpret_cast<Handler>(&arithmetic<Operation, false, A, B, C>);
  }

  template <class Operation>
  static Handler unary(InstructionShape const& shape) {
    if (shape.a == OperandPlace::lane) return stored<Operation, Lane, None, None>(shape.store);
    if (shape.a == OperandPlace::accumulator) return stored<Operation, Accumulator, None, None>(shape.store);
    return nullptr;
  }

  template <class Operation>
  static Handler move(InstructionShape const& shape) {
    if (shape.a == OperandPlace::uniform) return stored<Operation, Uniform, None, None>(shape.store);
    return unary<Operation>(shape);
  }

  template <class Operation, class C>
  static Handler commutative_with(InstructionShape const& shape) {
    if (shape.a == OperandPlace::lane) {
      if (shape.b == OperandPlace::lane) return stored<Operation, Lane, Lane, C>(shape.store);
      if (shape.b == OperandPlace::uniform) return stored<Operation, Lane, Uniform, C>(shape.store);
    }
    if (shape.a == OperandPlace::accumulator) {
      if (shape.b == OperandPlace::lane) return stored<Operation, Accumulator, Lane, C>(shape.store);
      if (shape.b == OperandPlace::uniform) return stored<Operation, Accumulator, Uniform, C>(shape.store);
      if (shape.b == OperandPlace::accumulator) return stored<Operation, Accumulator, Accumulator, C>(shape.store);
    }
    return nullptr;
  }

  template <class Operation>
  static Handler commutative(InstructionShape const& shape) {
    return commutative_with<Operation, None>(shape);
  }

  template <class Operation>
  static Handler multiply_add(InstructionShape const& shape) {
    if (shape.c == OperandPlace::lane) return commutative_with<Operation, Lane>(shape);
    if (shape.c == OperandPlace::uniform) return commutative_with<Operation, Uniform>(shape);
    if (shape.c == OperandPlace::accumulator) return commutative_with<Operation, Accumulator>(shape);
    return nullptr;
  }

  template <class Operation>
  static Handler ordered(InstructionShape const& shape) {
    if (shape.a == OperandPlace::uniform) {
      if (shape.b == OperandPlace::lane) return stored<Operation, Uniform, Lane, None>(shape.store);
      if (shape.b == OperandPlace::accumulator) return stored<Operation, Uniform, Accumulator, None>(shape.store);
    }
    if (shape.a == OperandPlace::lane && shape.b == OperandPlace::accumulator)
      return stored<Operation, Lane, Accumulator, None>(shape.store);
    return commutative_with<Operation, None>(shape);
  }

  template <class Operation>
  static Handler rare(InstructionShape const& shape) {
    if (shape.a == OperandPlace::lane) {
      if (shape.b == OperandPlace::lane) return Handler(&arithmetic<Operation, true, Lane, Lane, None>);
      if (shape.b == OperandPlace::uniform) return Handler(&arithmetic<Operation, true, Lane, Uniform, None>);
    }
    if (shape.a == OperandPlace::uniform && shape.b == OperandPlace::lane)
      return Handler(&arithmetic<Operation, true, Uniform, Lane, None>);
    return nullptr;
  }

  template <class Operation>
  static Handler rare_unary(InstructionShape const& shape) {
    return shape.a == OperandPlace::lane ? Handler(&arithmetic<Operation, true, Lane, None, None>) : nullptr;
  }

  static Handler select(InstructionShape const& shape) {
    if (shape.a != OperandPlace::lane) return nullptr;
    if (shape.b == OperandPlace::lane && shape.c == OperandPlace::lane) return Handler(&arithmetic<Select, true, Lane, Lane, Lane>);
    if (shape.b == OperandPlace::lane && shape.c == OperandPlace::uniform)
      return Handler(&arithmetic<Select, true, Lane, Lane, Uniform>);
    if (shape.b == OperandPlace::uniform && shape.c == OperandPlace::lane)
      return Handler(&arithmetic<Select, true, Lane, Uniform, Lane>);
    if (shape.b == OperandPlace::uniform && shape.c == OperandPlace::uniform)
      return Handler(&arithmetic<Select, true, Lane, Uniform, Uniform>);
    return nullptr;
  }

  static Handler handler(InstructionShape const& shape) {
    switch (shape.opcode) {
      case Opcode::move:
        return move<Move>(shape);
      case Opcode::negate:
        return unary<Negate>(shape);
      case Opcode::add:
        return commutative<Add>(shape);
      case Opcode::subtract:
        return ordered<Subtract>(shape);
      case Opcode::multiply:
        return commutative<Multiply>(shape);
      case Opcode::divide:
        return ordered<Divide>(shape);
      case Opcode::fused:
        return multiply_add<Fused>(shape);
      case Opcode::fused_subtract:
        return multiply_add<FusedSubtract>(shape);
      case Opcode::fused_negate:
        return multiply_add<FusedNegate>(shape);
      case Opcode::fused_both:
        return multiply_add<FusedBoth>(shape);
      case Opcode::square_root:
        return unary<SquareRoot>(shape);
      case Opcode::absolute:
        return unary<Absolute>(shape);
      case Opcode::sign:
        return rare_unary<Sign>(shape);
      case Opcode::minimum:
        return rare<Minimum>(shape);
      case Opcode::maximum:
        return rare<Maximum>(shape);
      case Opcode::floor:
        return rare_unary<Floor>(shape);
      case Opcode::less:
        return rare<Less>(shape);
      case Opcode::less_equal:
        return rare<LessEqual>(shape);
      case Opcode::equal:
        return rare<Equal>(shape);
      case Opcode::conjunction:
        return rare<Conjunction>(shape);
      case Opcode::disjunction:
        return rare<Disjunction>(shape);
      case Opcode::negation:
        return rare_unary<Negation>(shape);
      case Opcode::select:
        return select(shape);
      case Opcode::call_unary:
        return Handler(&call_unary);
      case Opcode::call_binary:
        return Handler(&call_binary);
    }
    return nullptr;
  }

  static void run(Step const* steps, char* file) { go_on(steps, file, (static_cast<void>(I), zero())...); }
};

template <class Answer, class Question>
Answer ask(int width, Question const& question) {
  switch (width / vector_lanes) {
    case 1:
      return question(Machine<0>{});
    case 2:
      return question(Machine<0, 1>{});
    case 4:
      return question(Machine<0, 1, 2, 3>{});
    default:
      return question(Machine<0, 1, 2, 3, 4, 5, 6, 7>{});
  }
}
