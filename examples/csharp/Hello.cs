// The program of examples/c in C#, by P/Invoke: structs and functions are written again from redman.h.
//   mcs -unsafe Hello.cs && mono Hello.exe POLICY [bench]
using System;
using System.Runtime.InteropServices;
using static System.FormattableString;

static unsafe class Hello {
  const int RDM_OK = 0, RDM_AUTORESET_NEXT_STEP = 1, RDM_BASELINE_HOLD = 1;
  // The members that are used here; Size is that of the whole struct.
  [StructLayout(LayoutKind.Sequential, Size = 56)]
  struct PoolConfig {
    public uint struct_size; public int num_envs; public byte* task; public ulong seed; public int threads, autoreset;
  }
  [StructLayout(LayoutKind.Sequential, Size = 48)]
  struct Spec { public uint struct_size; }
  [StructLayout(LayoutKind.Sequential, Size = 120)]
  struct Buffers { public uint struct_size, reserved; public float* obs, final_obs, action, reward, cost; }
  [StructLayout(LayoutKind.Sequential, Size = 56)]
  struct PolicyInfo { public uint struct_size; public int obs_dim, action_dim, action_repeat; }

  [DllImport("redman")] static extern IntPtr rdm_last_error();
  [DllImport("redman")] static extern int rdm_pool_config_init(PoolConfig* c, UIntPtr size);
  [DllImport("redman")] static extern int rdm_pool_create(out IntPtr pool, PoolConfig* c);
  [DllImport("redman")] static extern void rdm_pool_destroy(IntPtr p);
  [DllImport("redman")] static extern int rdm_pool_get_spec(IntPtr p, ref Spec io);
  [DllImport("redman")] static extern int rdm_pool_get_buffers(IntPtr p, ref Buffers io);
  [DllImport("redman")] static extern int rdm_pool_reset(IntPtr p, ulong[] seeds, byte[] mask);
  [DllImport("redman")] static extern int rdm_pool_step(IntPtr p);
  [DllImport("redman")] static extern int rdm_pool_baseline(IntPtr p, int kind);
  [DllImport("redman")] static extern int rdm_pool_get_hash(IntPtr p, int env, out ulong hash);
  [DllImport("redman")] static extern int rdm_policy_read_file(out IntPtr policy, string path);
  [DllImport("redman")] static extern void rdm_policy_destroy(IntPtr p);
  [DllImport("redman")] static extern int rdm_policy_get_info(IntPtr p, ref PolicyInfo io);
  [DllImport("redman")] static extern int rdm_policy_check(IntPtr p, ref Spec spec);
  [DllImport("redman")] static extern UIntPtr rdm_policy_scratch(IntPtr p, int rows);
  [DllImport("redman")] static extern int rdm_policy_act(IntPtr p, float* obs, int rows, float* noise, float* action,
                                                         byte[] scratch, UIntPtr scratch_bytes);
  [DllImport("libc")] static extern long clock(); // CPU time of the process, us

  static string Text => Marshal.PtrToStringAnsi(rdm_last_error()); // UTF-8 on Linux
  static void Check(int result) { if (result != RDM_OK) throw new Exception(Text); }

  // Worlds at the start of their first episode, with actions that hold the start pose.
  static IntPtr MakePool(string task, int num_envs, ulong seed) {
    PoolConfig config;
    Check(rdm_pool_config_init(&config, (UIntPtr)sizeof(PoolConfig)));
    config.num_envs = num_envs;
    config.seed = seed;
    config.autoreset = RDM_AUTORESET_NEXT_STEP; // ended worlds rest until the next step
    fixed (byte* name = System.Text.Encoding.UTF8.GetBytes(task + "\0")) {
      config.task = name;
      Check(rdm_pool_create(out IntPtr pool, &config));
      Check(rdm_pool_reset(pool, null, null));
      Check(rdm_pool_baseline(pool, RDM_BASELINE_HOLD));
      return pool;
    }
  }

  // 75 steps; without a policy the start pose is held. Return and cost are of world 0, the hash of all states.
  static (double sum, double cost, ulong hash) Play(IntPtr policy) {
    var pool = MakePool("hand_over_safe_finger", 4, 7);
    var spec = new Spec { struct_size = (uint)sizeof(Spec) };
    var rows = new Buffers { struct_size = (uint)sizeof(Buffers) };
    var info = new PolicyInfo { struct_size = (uint)sizeof(PolicyInfo) };
    byte[] scratch = null;
    Check(rdm_pool_get_spec(pool, ref spec));
    Check(rdm_pool_get_buffers(pool, ref rows));
    if (policy != IntPtr.Zero) {
      Check(rdm_policy_check(policy, ref spec));
      Check(rdm_policy_get_info(policy, ref info));
      scratch = new byte[(int)rdm_policy_scratch(policy, 4)];
    }
    double sum = 0, cost = 0;
    for (int t = 0; t < 75; ++t) {
      if (scratch != null && t % info.action_repeat == 0)
        Check(rdm_policy_act(policy, rows.obs, 4, null, rows.action, scratch, (UIntPtr)scratch.Length));
      Check(rdm_pool_step(pool));
      sum += rows.reward[0];
      cost += rows.cost[0];
    }
    Check(rdm_pool_get_hash(pool, -1, out ulong hash));
    rdm_pool_destroy(pool);
    return (sum, cost, hash);
  }

  // CPU seconds of one step of the pool.
  static double Time(string task, int num_envs, int calls) {
    var pool = MakePool(task, num_envs, 0);
    for (int t = 0; t < calls; ++t) Check(rdm_pool_step(pool)); // warms up
    long start = clock();
    for (int t = 0; t < calls; ++t) Check(rdm_pool_step(pool));
    double seconds = (clock() - start) * 1e-6;
    rdm_pool_destroy(pool);
    return seconds / calls;
  }

  static void Run(string path, bool bench) {
    var held = Play(IntPtr.Zero);
    Console.WriteLine(Invariant($"hold cost {held.cost:F0} hash {held.hash:x16}"));
    Check(rdm_policy_read_file(out IntPtr policy, path));
    var played = Play(policy);
    rdm_policy_destroy(policy);
    Console.WriteLine(Invariant($"policy return {played.sum:F4} cost {played.cost:F0} hash {played.hash:x16}"));
    if (!bench) return;
    Console.WriteLine(Invariant($"bandit {1e9 * Time("bandit", 1, 1000000):F0} ns a step"));
    Console.WriteLine(Invariant($"hand_over {1 / Time("hand_over_safe_finger", 1, 40000):F0} steps/s of 1 world"));
    Console.WriteLine(Invariant($"hand_over {64 / Time("hand_over_safe_finger", 64, 1000):F0} steps/s of 64 worlds"));
  }

  static void Main(string[] arguments) {
    try {
      if (arguments.Length < 1) throw new Exception("usage: Hello.exe POLICY [bench]");
      Run(arguments[0], arguments.Length > 1);
    } catch (Exception e) {
      Console.Error.WriteLine("hello: " + e.Message);
      Environment.ExitCode = 1;
    }
  }
}
