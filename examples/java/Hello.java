// The program of examples/c in Java, by JNA's direct calls: structs and functions are written again from redman.h.
//   java -cp /usr/share/java/jna.jar Hello.java POLICY [bench]
import static java.util.Locale.ROOT;
import com.sun.jna.*;

class Hello {
  static final int RDM_OK = 0, RDM_AUTORESET_NEXT_STEP = 1, RDM_BASELINE_HOLD = 1;
  // Structs with the members that are used here; `rest` is what follows.
  @Structure.FieldOrder("struct_size")
  public static abstract class Sized extends Structure {
    public int struct_size;
    @Override public void write() { struct_size = size(); super.write(); }
  }
  @Structure.FieldOrder({"num_envs", "task", "seed", "num_threads", "autoreset", "rest"})
  public static class PoolConfig extends Sized {
    public int num_envs; public String task; public long seed;
    public int num_threads, autoreset; public long[] rest = new long[3];
  }
  @Structure.FieldOrder("rest")
  public static class Spec extends Sized { public int[] rest = new int[11]; }
  @Structure.FieldOrder({"reserved", "obs", "final_obs", "action", "reward", "cost", "rest"})
  public static class Buffers extends Sized {
    public int reserved; public Pointer obs, final_obs, action, reward, cost; public long[] rest = new long[9];
  }
  @Structure.FieldOrder({"obs_dim", "action_dim", "action_repeat", "rest"})
  public static class PolicyInfo extends Sized {
    public int obs_dim, action_dim, action_repeat; public long[] rest = new long[5];
  }

  static native String rdm_last_error();
  static native int rdm_pool_config_init(PoolConfig c, long size);
  static native int rdm_pool_create(long[] pool, PoolConfig c); // a handle is its address
  static native void rdm_pool_destroy(long pool);
  static native int rdm_pool_get_spec(long pool, Spec io);
  static native int rdm_pool_get_buffers(long pool, Buffers io);
  static native int rdm_pool_reset(long pool, long[] seeds, byte[] mask);
  static native int rdm_pool_step(long pool);
  static native int rdm_pool_baseline(long pool, int kind);
  static native int rdm_pool_get_hash(long pool, int env, long[] hash);
  static native int rdm_policy_read_file(long[] policy, String path);
  static native void rdm_policy_destroy(long policy);
  static native int rdm_policy_get_info(long policy, PolicyInfo io);
  static native int rdm_policy_check(long policy, Spec spec);
  static native long rdm_policy_scratch(long policy, int rows);
  static native int rdm_policy_act(long policy, Pointer obs, int rows, Pointer noise, Pointer action,
                                   Pointer scratch, long scratch_bytes);
  static native long clock(); // CPU time of the process, us
  static { Native.register("redman"); }

  static void check(int result) {
    if (result != RDM_OK) throw new IllegalStateException(rdm_last_error());
  }

  // Worlds at the start of their first episode, with actions that hold the start pose.
  static long makePool(String task, int numEnvs, long seed) {
    var config = new PoolConfig();
    long[] pool = {0};
    check(rdm_pool_config_init(config, config.size()));
    config.task = task;
    config.num_envs = numEnvs;
    config.seed = seed;
    config.autoreset = RDM_AUTORESET_NEXT_STEP; // ended worlds rest until the next step
    check(rdm_pool_create(pool, config));
    check(rdm_pool_reset(pool[0], null, null));
    check(rdm_pool_baseline(pool[0], RDM_BASELINE_HOLD));
    return pool[0];
  }

  // 75 steps; with policy 0 the start pose is held. Prints return and cost of world 0, and the hash of all states.
  static void play(long policy, String format) {
    long pool = makePool("hand_over_safe_finger", 4, 7), hash[] = {0};
    var spec = new Spec();
    var rows = new Buffers();
    var info = new PolicyInfo();
    Memory scratch = null;
    check(rdm_pool_get_spec(pool, spec));
    check(rdm_pool_get_buffers(pool, rows));
    if (policy != 0) {
      check(rdm_policy_check(policy, spec));
      check(rdm_policy_get_info(policy, info));
      scratch = new Memory(rdm_policy_scratch(policy, 4));
    }
    double sum = 0, cost = 0;
    for (int t = 0; t < 75; ++t) {
      if (policy != 0 && t % info.action_repeat == 0)
        check(rdm_policy_act(policy, rows.obs, 4, null, rows.action, scratch, scratch.size()));
      check(rdm_pool_step(pool));
      sum += rows.reward.getFloat(0);
      cost += rows.cost.getFloat(0);
    }
    check(rdm_pool_get_hash(pool, -1, hash));
    rdm_pool_destroy(pool);
    System.out.printf(ROOT, format, sum, cost, hash[0]);
  }

  // CPU seconds of one step of the pool.
  static double measure(String task, int numEnvs, int calls) {
    long pool = makePool(task, numEnvs, 0);
    for (int t = 0; t < calls; ++t) check(rdm_pool_step(pool)); // warms up
    long start = clock();
    for (int t = 0; t < calls; ++t) check(rdm_pool_step(pool));
    double seconds = (clock() - start) * 1e-6;
    rdm_pool_destroy(pool);
    return seconds / calls;
  }

  public static void main(String[] arguments) {
    if (arguments.length < 1) throw new IllegalArgumentException("usage: Hello.java POLICY [bench]");
    play(0, "hold cost %2$.0f hash %3$016x%n");
    long[] policy = {0};
    check(rdm_policy_read_file(policy, arguments[0]));
    play(policy[0], "policy return %.4f cost %.0f hash %016x%n");
    rdm_policy_destroy(policy[0]);
    if (arguments.length < 2) return;
    System.out.printf(ROOT, "bandit %.0f ns a step%n", 1e9 * measure("bandit", 1, 1000000));
    System.out.printf(ROOT, "hand_over %.0f steps/s of 1 world%n", 1 / measure("hand_over_safe_finger", 1, 40000));
    System.out.printf(ROOT, "hand_over %.0f steps/s of 64 worlds%n", 64 / measure("hand_over_safe_finger", 64, 1000));
  }
}
