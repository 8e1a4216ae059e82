// Replaces the parts of Unity that the sketches in deploy/examples/unity use. Runs the haptic loop on DATASET.h5, whose active
// node 0, "tip", is the corner (0.1, 0.1, 0.1) m of a cube, and the component on FINGER.h5, a cube whose top a finger touches:
//
//   unity_sketch.exe DATASET.h5 FINGER.h5
using System;
using System.Globalization;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Threading;

namespace UnityEngine {
public struct Vector3 {
  public float x, y, z;
  public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
  public static Vector3 operator +(Vector3 a, Vector3 b) => new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
  public static Vector3 operator -(Vector3 a, Vector3 b) => new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
  public static float Dot(Vector3 a, Vector3 b) => a.x * b.x + a.y * b.y + a.z * b.z;
  public static Vector3 Cross(Vector3 a, Vector3 b) =>
      new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
public sealed class Transform {
  public Vector3 position;
  public Vector3 InverseTransformPoint(Vector3 place) => place;
  public Vector3 TransformDirection(Vector3 direction) => direction;
}
public sealed class Mesh {
  public Vector3[] vertices { get; set; }
  public int[] triangles { get; set; }
  public void MarkDynamic() { }
  public void RecalculateNormals() { }
  public void RecalculateBounds() { }
}
public sealed class MeshFilter { public Mesh mesh { get; set; } }
[AttributeUsage(AttributeTargets.Class)]
public sealed class RequireComponent : Attribute { public RequireComponent(Type _) { } }
public static class Application { public static string streamingAssetsPath => ""; }
public class MonoBehaviour {
  public readonly Transform transform = new Transform();
  private readonly MeshFilter filter = new MeshFilter();
  public T GetComponent<T>() => (T)(object)filter;
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

  /// Checks the surface in the caller's buffers, and its shape while the hand presses.
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

  private static void Send(PalpateOrgan organ, string message) {
    typeof(PalpateOrgan).GetMethod(message, BindingFlags.Instance | BindingFlags.NonPublic).Invoke(organ, null);
  }

  /// Runs the component like Unity's engine, with a tool that comes down on the middle of the top. Checks that the normals, which
  /// are Vector3.Cross of the edges, point out of the cube.
  private static void Component(string file) {
    var organ = new PalpateOrgan { dataset = file, tool = new UnityEngine.Transform() };
    Send(organ, "OnEnable");
    UnityEngine.Mesh mesh = organ.GetComponent<UnityEngine.MeshFilter>().mesh;
    var middle = new UnityEngine.Vector3(0.05f, 0.05f, -0.05f);
    bool outward = true;
    for (int n = 0; n < mesh.triangles.Length; n += 3) {
      UnityEngine.Vector3 a = mesh.vertices[mesh.triangles[n]], b = mesh.vertices[mesh.triangles[n + 1]],
                          c = mesh.vertices[mesh.triangles[n + 2]];
      outward = outward && UnityEngine.Vector3.Dot(UnityEngine.Vector3.Cross(b - a, c - a), a - middle) > 0;
    }
    Console.WriteLine(outward ? "outward" : "inside out");
    var atRest = (UnityEngine.Vector3[])mesh.vertices.Clone();
    float height = 0.105f, deepest = 0;
    for (int wait = 0; wait < 1000 && !(deepest > 1e-4f && organ.Force.z < 0); ++wait) {
      height = Math.Max(height - 1e-4f, 0.095f);
      organ.tool.position = new UnityEngine.Vector3(0.05f, 0.05f, -height);
      Send(organ, "Update");
      for (int n = 0; n < atRest.Length; ++n) deepest = Math.Max(deepest, mesh.vertices[n].z - atRest[n].z);
      Thread.Sleep(10);
    }
    Console.WriteLine(deepest > 1e-4f && organ.Force.z < 0 ? "component pressed" : "component felt nothing");
    Send(organ, "OnDisable");
  }

  private static void Area(string file) {
    DatasetHandle dataset;
    Native.Check(Native.palpate_dataset_open(file, IntPtr.Zero, out dataset));
    using (dataset) {
      AreaSample sample = dataset.AskArea(dataset.AreaCount() - 1, new Vector3d(0.0512, 0.0437, 0.104),
                                          new Vector3d(0.003, -0.002, -0.009));
      Console.WriteLine("area " + Words(sample.Force) + " inside " + sample.Inside);
    }
  }

  public static int Main(string[] arguments) {
    Print("AreaInfo", Marshal.SizeOf<AreaInfo>());
    Print("AreaSample", Marshal.SizeOf<AreaSample>());
    Print("DatasetInfo", Marshal.SizeOf<DatasetInfo>());
    Print("GuardOptions", Marshal.SizeOf<GuardOptions>());
    Print("GuardedForce", Marshal.SizeOf<GuardedForce>());
    Print("Sample", Marshal.SizeOf<Sample>());
    Print("Touch", Marshal.SizeOf<Touch>());
    try {
      Area(arguments[1]);
      Component(arguments[1]);
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
