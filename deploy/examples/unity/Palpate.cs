// libpalpate for Unity (or any C#), with the struct layouts of palpate.h: a sketch, used by PalpateOrgan.cs. The tests compile and
// run both files with Mono; they were NOT run in Unity.
//
// Copy libpalpate.so.0 as libpalpate.so, and the libraries that `ldd` names, into Assets/Plugins/x86_64. Unity is left-handed with
// y up, so convert positions and forces at one boundary (here: z is negated), and keep metres. Unity's triangles are clockwise
// seen from outside, Palpate's are counterclockwise, so the order of their corners is reversed too.
// The haptic loop has a thread of its own, because Update() runs at the frame rate. C# may stop any thread for garbage
// collection; if such a gap is reported (LoopLate), the guard makes the force zero. For a hard 1 kHz, write the loop in C.
using System;
using System.Diagnostics;
using System.Runtime.InteropServices;
using System.Threading;

namespace PalpateClient {

public enum Status { Ok = 0, InvalidArgument = 1, BadFile = 2, OutOfMemory = 3, Failed = 4 }

[Flags]
public enum Reading : uint { None = 0, Fresh = 1, Lost = 2, LoopLate = 4 }

[StructLayout(LayoutKind.Sequential)]
public struct Vector3d {
  public double X, Y, Z;
  public Vector3d(double x, double y, double z) { X = x; Y = y; Z = z; }
  public static Vector3d FromUnity(UnityEngine.Vector3 v) => new Vector3d(v.x, v.y, -v.z);
  public UnityEngine.Vector3 ToUnity() => new UnityEngine.Vector3((float)X, (float)Y, (float)-Z);
}

// Create() sets Size; palpate.h documents the members. `fixed` members need "Allow unsafe code".
[StructLayout(LayoutKind.Sequential)]
public struct DatasetInfo {  // 64 bytes
  public UIntPtr Size;
  public IntPtr Name, File, ContentId;
  public int ContactMode, SpaceCount, MethodCount, VertexCount, TriangleCount, Reserved;
  public double MaxForce;
  public static DatasetInfo Create() => new DatasetInfo { Size = (UIntPtr)Marshal.SizeOf<DatasetInfo>() };
}

[StructLayout(LayoutKind.Sequential)]
public unsafe struct Sample {  // 136 bytes
  public UIntPtr Size;
  public Vector3d Force;
  public fixed double Stiffness[9];
  public double Energy, ErrorBound, Coverage;
  public int Inside, Reserved;
  public static Sample Create() => new Sample { Size = (UIntPtr)sizeof(Sample) };
}

[StructLayout(LayoutKind.Sequential)]
public unsafe struct Touch {  // 392 bytes
  public UIntPtr Size;
  public int Touching, Stepped, Inside, Triangle;
  public Vector3d Force;
  public fixed double Stiffness[9];
  public double Energy, ErrorBound, Coverage;
  public Vector3d Barycentric, Anchor, Normal, Displacement;
  public double Gap;
  public int ShareCount;
  public fixed int ShareSpaces[9];
  public fixed double ShareWeights[9];
  public double Beyond;
  public Vector3d Drive;
  public static Touch Create() => new Touch { Size = (UIntPtr)sizeof(Touch) };
}

[StructLayout(LayoutKind.Sequential)]
public struct AreaInfo {  // 40 bytes
  public UIntPtr Size;
  public IntPtr Name;
  public double FingerRadius, WorkspaceRadius;
  public int SiteCount, Reserved;
  public static AreaInfo Create() => new AreaInfo { Size = (UIntPtr)Marshal.SizeOf<AreaInfo>() };
}

[StructLayout(LayoutKind.Sequential)]
public unsafe struct AreaSample {  // 192 bytes
  public UIntPtr Size;
  public Vector3d Force;
  public fixed double Stiffness[9];
  public Vector3d Drive, At;
  public double Energy, ErrorBound, Coverage;
  public int Inside, Triangle;
  public double Distance;
  public static AreaSample Create() => new AreaSample { Size = (UIntPtr)sizeof(AreaSample) };
}

[StructLayout(LayoutKind.Sequential)]
public struct GuardOptions {  // 72 bytes
  public UIntPtr Size;
  public double Period, MaxForce, MaxSlew, Ramp, Stall, MaxStiffness, EnergyCredit, Delay;
  public static GuardOptions Create() => new GuardOptions { Size = (UIntPtr)Marshal.SizeOf<GuardOptions>() };
}

[StructLayout(LayoutKind.Sequential)]
public struct GuardedForce {  // 48 bytes
  public UIntPtr Size;
  public Vector3d Force;
  public double Passivity;
  public uint Guards, Reserved;
  public static GuardedForce Create() => new GuardedForce { Size = (UIntPtr)Marshal.SizeOf<GuardedForce>() };
}

public abstract class Handle : SafeHandle {
  protected Handle() : base(IntPtr.Zero, true) { }
  public override bool IsInvalid => handle == IntPtr.Zero;
}
public sealed class DatasetHandle : Handle {
  protected override bool ReleaseHandle() { Native.palpate_dataset_close(handle); return true; }
}
public sealed class ContactHandle : Handle {  // keeps its dataset in memory, so finalizers may run in any order
  protected override bool ReleaseHandle() { Native.palpate_contact_destroy(handle); return true; }
}
public sealed class GuardHandle : Handle {
  protected override bool ReleaseHandle() { Native.palpate_guard_destroy(handle); return true; }
}

/// Uses `ref` even if the library only reads, because Mono crashes on an `in` parameter next to an `out` handle.
public static class Native {
  private const string Library = "palpate";
  [DllImport(Library)] public static extern int palpate_abi_version();
  [DllImport(Library)] public static extern IntPtr palpate_last_error();
  [DllImport(Library)] public static extern Status palpate_dataset_open(
      [MarshalAs(UnmanagedType.LPUTF8Str)] string file, IntPtr options, out DatasetHandle dataset);
  [DllImport(Library)] public static extern void palpate_dataset_close(IntPtr dataset);
  [DllImport(Library)] public static extern Status palpate_dataset_describe(DatasetHandle dataset, ref DatasetInfo info);
  [DllImport(Library)] public static extern Status palpate_dataset_vertices(
      DatasetHandle dataset, [Out] double[] vertices, UIntPtr capacity);
  [DllImport(Library)] public static extern Status palpate_dataset_triangles(
      DatasetHandle dataset, [Out] int[] triangles, UIntPtr capacity);
  [DllImport(Library)] public static extern Status palpate_query(
      DatasetHandle dataset, int space, int method, ref Vector3d displacement, ref Sample sample);
  [DllImport(Library)] public static extern Status palpate_dataset_area_count(DatasetHandle dataset, out int count);
  [DllImport(Library)] public static extern Status palpate_dataset_area(DatasetHandle dataset, int area, ref AreaInfo info);
  [DllImport(Library)] public static extern Status palpate_area_query(
      DatasetHandle dataset, int area, ref Vector3d at, ref Vector3d displacement, ref AreaSample sample);
  [DllImport(Library)] public static extern Status palpate_contact_create(
      DatasetHandle dataset, IntPtr options, out ContactHandle contact);
  [DllImport(Library)] public static extern void palpate_contact_destroy(IntPtr contact);
  [DllImport(Library)] public static extern Status palpate_contact_update(
      ContactHandle contact, ref Vector3d tool, int hold, ref Touch touch);
  [DllImport(Library)] public static extern Status palpate_touch_displacements(
      DatasetHandle dataset, ref Touch touch, [Out] float[] displacements, UIntPtr capacity);
  [DllImport(Library)] public static extern Status palpate_guard_defaults(
      [MarshalAs(UnmanagedType.LPUTF8Str)] string device, double period, ref GuardOptions options);
  [DllImport(Library)] public static extern Status palpate_guard_create(ref GuardOptions options, out GuardHandle guard);
  [DllImport(Library)] public static extern void palpate_guard_destroy(IntPtr guard);
  [DllImport(Library)] public static extern Status palpate_guard_limit(
      GuardHandle guard, ref Vector3d tool, ref Touch touch, Reading flags, ref GuardedForce force);

  /// Throws the error of a failed call. Errors are per thread: call this on the thread of the failed call.
  public static void Check(Status status) {
    if (status != Status.Ok)
      throw new InvalidOperationException(status + ": " + Marshal.PtrToStringUTF8(palpate_last_error()));
  }
}

/// Queries of a dataset for rendering and simulation. Any thread.
public static class Datasets {
  /// Returns the vertices of the surface at rest, in Unity's frame.
  public static UnityEngine.Vector3[] UnityVertices(this DatasetHandle dataset) {
    var numbers = new double[3 * InfoOf(dataset).VertexCount];
    Native.Check(Native.palpate_dataset_vertices(dataset, numbers, (UIntPtr)numbers.Length));
    var vertices = new UnityEngine.Vector3[numbers.Length / 3];
    for (int n = 0; n < vertices.Length; ++n)
      vertices[n] = new Vector3d(numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]).ToUnity();
    return vertices;
  }

  /// Returns three vertices per triangle, clockwise seen from outside (Palpate's order reversed).
  public static int[] UnityTriangles(this DatasetHandle dataset) {
    var corners = new int[3 * InfoOf(dataset).TriangleCount];
    Native.Check(Native.palpate_dataset_triangles(dataset, corners, (UIntPtr)corners.Length));
    for (int n = 0; n < corners.Length; n += 3) Array.Reverse(corners, n + 1, 2);
    return corners;
  }

  /// Returns the number of surfaces that a finger can touch; zero if the dataset has only single active nodes.
  public static int AreaCount(this DatasetHandle dataset) {
    Native.Check(Native.palpate_dataset_area_count(dataset, out int count));
    return count;
  }

  /// Returns the force on a finger at a place of an area and the force that drives it along the surface. Needs no contact.
  /// Metres and newtons, frame of the scene.
  public static AreaSample AskArea(this DatasetHandle dataset, int area, Vector3d at, Vector3d displacement) {
    var sample = AreaSample.Create();
    Native.Check(Native.palpate_area_query(dataset, area, ref at, ref displacement, ref sample));
    return sample;
  }

  private static DatasetInfo InfoOf(DatasetHandle dataset) {
    var info = DatasetInfo.Create();
    Native.Check(Native.palpate_dataset_describe(dataset, ref info));
    return info;
  }
}

/// Haptic device of the simulator.
public interface IHapticDevice {
  bool Read(out Vector3d position);  ///< metres, frame of the scene; false if there is no new position
  bool Lost { get; }
  void Write(Vector3d force);        ///< newtons
}

/// Haptic loop on a thread of its own. Update() reads LastTouch.
public sealed class HapticLoop : IDisposable {
  private const double Period = 1e-3;
  private readonly DatasetHandle dataset;
  private readonly ContactHandle contact;
  private readonly GuardHandle guard;
  private readonly IHapticDevice device;
  private readonly Thread thread;
  private readonly object seenLock = new object();
  private Touch seen = Touch.Create();
  private volatile bool running = true;

  public HapticLoop(string file, IHapticDevice device, string profile = "touch") {
    if (Native.palpate_abi_version() != 0) throw new InvalidOperationException("libpalpate must have ABI version 0");
    this.device = device;
    Native.Check(Native.palpate_dataset_open(file, IntPtr.Zero, out dataset));
    Native.Check(Native.palpate_contact_create(dataset, IntPtr.Zero, out contact));
    var limits = GuardOptions.Create();
    Native.Check(Native.palpate_guard_defaults(profile, Period, ref limits));
    Native.Check(Native.palpate_guard_create(ref limits, out guard));
    thread = new Thread(Run) { IsBackground = true, Priority = ThreadPriority.Highest };
    thread.Start();
  }

  /// Dataset for rendering and simulation; closed by Dispose().
  public DatasetHandle Dataset => dataset;
  public Touch LastTouch { get { lock (seenLock) return seen; } }

  /// Writes the displacements of the surface's vertices, metres, frame of the scene. Call it from Update().
  public void Deform(float[] displacements) {
    Touch touch = LastTouch;
    Native.Check(Native.palpate_touch_displacements(dataset, ref touch, displacements, (UIntPtr)displacements.Length));
  }

  private void Run() {
    var clock = Stopwatch.StartNew();
    var touch = Touch.Create();
    var force = GuardedForce.Create();
    double due = 0;
    var tool = new Vector3d();
    while (running) {
      due += Period;
      Reading flags = Reading.None;
      double late = clock.Elapsed.TotalSeconds - due;
      if (late > 20 * Period) {  // the loop hung: report it, and do not try to catch up
        flags |= Reading.LoopLate;
        due += late;
      }
      if (device.Read(out Vector3d position)) {
        tool = position;
        flags |= Reading.Fresh;
      }
      if (device.Lost) flags |= Reading.Lost;
      bool done = Native.palpate_contact_update(contact, ref tool, 1, ref touch) == Status.Ok &&
                  Native.palpate_guard_limit(guard, ref tool, ref touch, flags, ref force) == Status.Ok;
      device.Write(done ? force.Force : new Vector3d());
      if (Monitor.TryEnter(seenLock)) {  // a frame may miss a tick, but a tick never waits
        seen = touch;
        Monitor.Exit(seenLock);
      }
      while (running && clock.Elapsed.TotalSeconds < due) Thread.Yield();
    }
    device.Write(new Vector3d());
  }

  public void Dispose() {
    running = false;
    thread.Join();
    contact.Dispose();
    guard.Dispose();
    dataset.Dispose();
  }
}

}  // namespace PalpateClient
