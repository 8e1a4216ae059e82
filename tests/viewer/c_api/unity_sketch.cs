// What of Unity the sketch deploy/examples/unity/Palpate.cs needs, and a program that runs its haptic loop on a dataset of
// a body whose active node 0, "tip", is the corner (0.1, 0.1, 0.1) m of a cube:
//
//   unity_sketch.exe DATASET.h5
using System;
using System.Globalization;
using System.Runtime.InteropServices;
using System.Threading;

namespace UnityEngine {
public struct Vector3 {
  public float x, y, z;
  public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
}
}

namespace PalpateClient {

/// A hand that presses the corner of the cube along its diagonal, a little more with every reading.
sealed class PressingHand : IHapticDevice {
  private readonly object seen = new object();
  private int readings;
  private double largest;

  public bool Lost => false;
  public bool Read(out Vector3d position) {
    double inward = Math.Min(-1e-3 + 1e-4 * readings++, 4e-3), x = 0.1 - inward / Math.Sqrt(3);
    position = new Vector3d(x, x, x);
    return true;
  }
  public void Write(Vector3d force) {
    lock (seen) largest = Math.Max(largest, Math.Sqrt(force.X * force.X + force.Y * force.Y + force.Z * force.Z));
  }
  public double LargestForce { get { lock (seen) return largest; } }
}

static class Program {
  private static void Print(string name, int size) { Console.WriteLine("size " + name + " " + size); }
  private static string Words(Vector3d v) {
    return string.Format(CultureInfo.InvariantCulture, "{0:R} {1:R} {2:R}", v.X, v.Y, v.Z);
  }

  private static void Query(DatasetHandle dataset) {
    var displacement = new Vector3d(-0.003, -0.002, -0.004);
    var sample = Sample.Create();
    Native.Check(Native.palpate_query(dataset, 0, 0, ref displacement, ref sample));
    Console.WriteLine("query tip " + Words(displacement) + " force " + Words(sample.Force));
  }

  /// The surface in the buffers of the caller, and its shape while the hand presses.
  private static bool Press(string file, DatasetHandle dataset) {
    var info = DatasetInfo.Create();
    Native.Check(Native.palpate_dataset_describe(dataset, ref info));
    var vertices = new double[3 * info.VertexCount];
    Native.Check(Native.palpate_dataset_vertices(dataset, vertices, (UIntPtr)vertices.Length));
    var triangles = new int[3 * info.TriangleCount];
    Native.Check(Native.palpate_dataset_triangles(dataset, triangles, (UIntPtr)triangles.Length));
    var hand = new PressingHand();
    var shape = new float[vertices.Length];
    bool touching = false;
    using (var loop = new HapticLoop(file, hand)) {
      for (int wait = 0; wait < 1000 && !(touching && hand.LargestForce > 0); ++wait) {
        Thread.Sleep(10);
        touching = loop.LastTouch.Touching != 0;
      }
      loop.Deform(shape);
    }
    double deepest = 0;
    foreach (float moved in shape) deepest = Math.Max(deepest, Math.Abs(moved));
    Console.WriteLine(touching && hand.LargestForce > 0 && deepest > 0 ? "touching" : "nothing felt");
    return touching;
  }

  public static int Main(string[] arguments) {
    Print("DatasetInfo", Marshal.SizeOf<DatasetInfo>());
    Print("GuardOptions", Marshal.SizeOf<GuardOptions>());
    Print("GuardedForce", Marshal.SizeOf<GuardedForce>());
    Print("Sample", Marshal.SizeOf<Sample>());
    Print("Touch", Marshal.SizeOf<Touch>());
    try {
      DatasetHandle dataset;
      Native.Check(Native.palpate_dataset_open(arguments[0], IntPtr.Zero, out dataset));
      using (dataset) {
        Query(dataset);
        return Press(arguments[0], dataset) ? 0 : 1;
      }
    } catch (InvalidOperationException error) {
      Console.WriteLine(error.Message);
      return 1;
    }
  }
}

}  // namespace PalpateClient
